//! Which suggestions a sketch earns, and in which order.

use super::surface::Coverage;
use blobtree::Color;

/// What can be done with a sketch, and the picture that stands for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Icon {
    /// Blow the outline up.
    Inflate,
    /// Make the outline thick.
    Sweep,
    /// Turn the outline about an axis.
    Revolve,
    /// Cut the outline through the model.
    CutHole,
    /// Cut off what the outline covers of the model's edge.
    CutAcross,
    /// Blow the outline up and let it flow into the model.
    BlendOn,
    /// Put tubes along the strokes onto the model.
    DrawOn,
    /// Move the outline along the open stroke.
    SweepAlong,
}

/// What the strokes are, for the rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Facts {
    /// Whether they make a closed outline.
    pub closed: bool,
    /// Whether there is an open stroke besides the outline.
    pub path: bool,
    /// Whether that stroke can only be meant as a path or an axis, not as decoration.
    pub meant: bool,
    /// Whether it is meant and straight.
    pub axis: bool,
    /// How much of them lies on the model.
    pub coverage: Coverage,
    /// Whether there is anything under them to draw on, construction nodes included.
    pub drawable: bool,
}

/// A line of the table: what is suggested, where it ranks, and why.
struct Rule {
    icon: Icon,
    when: fn(&Facts) -> bool,
    /// The rank if the strokes lie beside, across and inside the model; 1 comes first, none is not suggested.
    ranks: [Option<u8>; 3],
}

/// The table.
///
/// Its reasons are those of Schmidt & Wyvill 2011, §11.2.1 to 11.2.3: closed contours make sweep surfaces;
/// what removes or draws needs a surface under the strokes. The order is ours: first what can only be meant
/// here, then what also could be. A shape of its own is always possible, and comes last where strokes cover
/// the model.
const RULES: [Rule; 12] = [
    // An outline and a path beside it: nobody draws both to inflate them.
    Rule { icon: Icon::SweepAlong, when: |f| f.closed && f.meant && !f.axis, ranks: [Some(1); 3] },
    // A straight stroke is an axis before it is a path.
    Rule { icon: Icon::SweepAlong, when: |f| f.closed && f.axis, ranks: [Some(2); 3] },
    // Inside the silhouette, cutting comes first: the paper's holes; across it, growing does: its blends.
    Rule { icon: Icon::CutHole, when: |f| f.closed, ranks: [None, None, Some(3)] },
    Rule { icon: Icon::BlendOn, when: |f| f.closed, ranks: [None, Some(3), Some(4)] },
    Rule { icon: Icon::CutAcross, when: |f| f.closed, ranks: [None, Some(4), None] },
    // Open strokes on the surface can only be drawn onto it; closed ones seldom are.
    Rule { icon: Icon::DrawOn, when: |f| !f.closed && f.drawable, ranks: [Some(1); 3] },
    Rule { icon: Icon::DrawOn, when: |f| f.closed && f.drawable, ranks: [Some(6), Some(5), Some(5)] },
    // A shape of its own.
    Rule { icon: Icon::Inflate, when: |f| f.closed, ranks: [Some(3), Some(6), Some(6)] },
    Rule { icon: Icon::Sweep, when: |f| f.closed, ranks: [Some(4), Some(7), Some(7)] },
    Rule { icon: Icon::Revolve, when: |f| f.closed && !f.axis, ranks: [Some(5), Some(8), Some(8)] },
    // Tails, smiles and whiskers are paths to nobody, or hardly.
    Rule { icon: Icon::SweepAlong, when: |f| f.closed && f.path && !f.meant, ranks: [Some(9); 3] },
    // With an axis drawn beside it, the outline is meant to turn about it.
    Rule { icon: Icon::Revolve, when: |f| f.closed && f.axis, ranks: [Some(1); 3] },
];

/// What to suggest, the likeliest first.
pub(super) fn ranked(facts: &Facts) -> Vec<Icon> {
    let place = facts.coverage as usize;
    let holds = RULES.iter().filter(|rule| (rule.when)(facts));
    let mut ranked: Vec<(u8, Icon)> =
        holds.filter_map(|rule| Some((rule.ranks[place]?, rule.icon))).collect();
    ranked.sort_unstable();
    ranked.into_iter().map(|(_, icon)| icon).collect()
}

impl Icon {
    /// The name, as on a button.
    pub fn name(self) -> &'static str {
        match self {
            Self::Inflate => "Inflate",
            Self::Sweep => "Make thick",
            Self::Revolve => "Turn round",
            Self::CutHole => "Cut a hole",
            Self::CutAcross => "Cut off",
            Self::BlendOn => "Grow",
            Self::DrawOn => "Draw on",
            Self::SweepAlong => "Pull along",
        }
    }

    /// What it does, said to a child.
    pub fn sentence(self) -> &'static str {
        match self {
            Self::Inflate => "Blow it up like a balloon.",
            Self::Sweep => "Make it thick, like a biscuit.",
            Self::Revolve => "Spin it round, like a vase.",
            Self::CutHole => "Cut a hole here.",
            Self::CutAcross => "Cut this piece off.",
            Self::BlendOn => "Let it grow out of the shape.",
            Self::DrawOn => "Draw this line onto the shape.",
            Self::SweepAlong => "Pull the shape along the line.",
        }
    }

    /// The colour of what it does: green makes something new, blue adds to what is there, red takes away. They
    /// also differ in lightness, for eyes that do not tell them apart.
    pub fn color(self) -> Color {
        match self {
            Self::Inflate | Self::Sweep | Self::Revolve | Self::SweepAlong => Color([0x7a, 0xc7, 0x4f]),
            Self::BlendOn | Self::DrawOn => Color([0x2b, 0x6c, 0xb0]),
            Self::CutHole | Self::CutAcross => Color([0xd6, 0x45, 0x3d]),
        }
    }

    /// The word by which programs call it.
    pub fn id(self) -> &'static str {
        match self {
            Self::Inflate => "inflate",
            Self::Sweep => "sweep",
            Self::Revolve => "revolve",
            Self::CutHole => "cut_hole",
            Self::CutAcross => "cut_across",
            Self::BlendOn => "blend_on",
            Self::DrawOn => "draw_on",
            Self::SweepAlong => "sweep_along",
        }
    }
}
