//! The print check in words and as JSON.

use crate::output::{Report, counted, long_vector, number, short};
use printable::SupportRule;
use printable::check::{Finding, Kind, PrintCheck, Stance, Walls};
use serde_json::{Value, json};

/// Findings of one kind that are told in words; JSON has more.
const TOLD: usize = 5;

/// Tells all of a check, and whether it found something.
pub fn tell(report: &mut Report, check: &PrintCheck) {
    tell_layers(report, check);
    tell_stance(report, &check.stance);
    tell_walls(report, check.walls.as_ref());
    tell_findings(report, check);
    report.found |= check.findings.iter().any(|finding| finding.kind.is_serious());
    report.put("print", as_json(check));
}

fn tell_layers(report: &mut Report, check: &PrintCheck) {
    let SupportRule { layer_height, overhang } = check.settings.rule;
    let (height, degrees) = (short(layer_height.mm()), short(overhang.degrees()));
    report.line(format!("layers          {} of {height} mm, overhangs to {degrees}°", check.layers.len()));
    let hanging = check.layers.iter().filter(|layer| layer.unsupported > 0.0).count();
    let most = match check.worst_layer().filter(|_| hanging > 0) {
        Some((k, worst)) => {
            format!(" in {}, {:.2} mm² of it in layer {k}", counted(hanging, "layer"), worst.unsupported)
        }
        None => String::new(),
    };
    report.line(format!("unsupported     {:.2} mm²{most}", check.unsupported()));
    report.line(format!("islands         {}", check.islands()));
    let (outside, inside) = (check.steep.outside, check.steep.inside);
    report.line(format!("steep facets    {outside:.2} mm² outside, {inside:.2} mm² in voids"));
}

fn tell_stance(report: &mut Report, stance: &Stance) {
    let contact = stance.contact;
    let line = match (stance.margin, stance.topple) {
        (Some(margin), Some(topple)) if margin > 0.0 => {
            format!("on {contact:.2} mm²; topples when tilted by {:.1}°", topple.to_degrees())
        }
        (Some(_), _) => format!("not by itself; touches the bed with {contact:.2} mm²"),
        _ => "on nothing that has an area".to_owned(),
    };
    report.line(format!("stands          {line}"));
}

fn tell_walls(report: &mut Report, walls: Option<&Walls>) {
    let line = match walls {
        Some(walls) => format!("{:.2} mm at the thinnest, half below {:.2} mm", walls.thinnest, walls.median),
        None => "none met".to_owned(),
    };
    report.line(format!("walls           {line} (sampled)"));
}

fn tell_findings(report: &mut Report, check: &PrintCheck) {
    for group in check.findings.chunk_by(|a, b| a.kind.name() == b.kind.name()) {
        for finding in group.iter().take(TOLD) {
            let word = if finding.kind.is_serious() { "problem" } else { "remark" };
            report.line(format!("{word:<15} {finding}"));
        }
        if group.len() > TOLD {
            let at_least = if group.len() == printable::check::MOST_FINDINGS { "at least " } else { "" };
            report.line(format!("{:<15} and {at_least}{} more of this kind", "", group.len() - TOLD));
        }
    }
    let verdict = match (check.is_support_free(), check.is_printable()) {
        (true, _) => "without supports",
        (false, true) => "without supports, though a slicer may add small ones",
        (false, false) => "not without supports",
    };
    report.line(format!("prints          {verdict}"));
}

fn as_json(check: &PrintCheck) -> Value {
    let SupportRule { layer_height, overhang } = check.settings.rule;
    let worst = check.worst_layer();
    json!({
        "layer_height_mm": number(layer_height.mm()),
        "max_overhang_degrees": number(overhang.degrees()),
        "tolerance_mm": check.settings.tolerance_mm,
        "support_free": check.is_support_free(),
        "printable": check.is_printable(),
        "layer_count": check.layers.len(),
        "unsupported_mm2": check.unsupported(),
        "worst_layer": worst.map(|(k, _)| k),
        "worst_layer_mm2": worst.map(|(_, layer)| layer.unsupported),
        "wide_mm2": check.wide(),
        "largest_excess_mm": check.largest_excess(),
        "islands": check.islands(),
        "detached_islands": check.layers.iter().map(|layer| layer.detached).sum::<usize>(),
        "steep_mm2": { "outside": check.steep.outside, "inside": check.steep.inside },
        "worst_overhang_degrees": check.steep.worst.map(f64::to_degrees),
        "stance": stance(&check.stance),
        "walls": check.walls.map(|walls| json!({
            "samples": walls.samples,
            "thinnest_mm": walls.thinnest,
            "thinnest_at": long_vector(walls.place),
            "percentile_1_mm": walls.percentile_1,
            "median_mm": walls.median,
            "thin_share": walls.thin_share,
        })),
        "voids": check.voids.iter().take(printable::check::MOST_FINDINGS).map(|void| json!({
            "volume_mm3": void.volume,
            "at": long_vector(void.place),
            "z": void.z,
        })).collect::<Vec<_>>(),
        "layers": layers(check),
        "findings": check.findings.iter().map(finding).collect::<Vec<_>>(),
    })
}

fn stance(stance: &Stance) -> Value {
    json!({
        "contact_mm2": stance.contact,
        "base_mm2": stance.base,
        "margin_mm": stance.margin,
        "topple_degrees": stance.topple.map(f64::to_degrees),
        "stands": stance.margin.is_some_and(|margin| margin > 0.0),
    })
}

/// The layers in which something was found.
fn layers(check: &PrintCheck) -> Value {
    let found = check.layers.iter().enumerate();
    let found = found.filter(|(_, l)| l.unsupported > 0.0 || l.islands > 0 || l.open_outlines > 0);
    let told = found.map(|(k, layer)| {
        json!({
            "layer": k,
            "z": layer.z,
            "area_mm2": layer.area,
            "regions": layer.regions,
            "unsupported_mm2": layer.unsupported,
            "wide_mm2": layer.wide,
            "islands": layer.islands,
            "open_outlines": layer.open_outlines,
        })
    });
    told.collect::<Vec<_>>().into()
}

fn finding(finding: &Finding) -> Value {
    let mut value = json!({
        "kind": finding.kind.name(),
        "serious": finding.kind.is_serious(),
        "at": long_vector(finding.place),
        "what": finding.to_string(),
    });
    if let Some(layer) = finding.layer {
        value["layer"] = layer.into();
    }
    let measures: &[(&str, f64)] = match finding.kind {
        Kind::Island { area } => &[("area_mm2", area)],
        Kind::Hangs { area, excess, .. } => &[("area_mm2", area), ("excess_mm", excess)],
        Kind::SteepBetweenLayers { area, worst } => {
            &[("area_mm2", area), ("worst_overhang_degrees", worst.to_degrees())]
        }
        Kind::ThinWall { thickness, share } => &[("thickness_mm", thickness), ("share", share)],
        Kind::ClosedVoid { volume } => &[("volume_mm3", volume)],
        _ => &[],
    };
    for &(name, measure) in measures {
        value[name] = measure.into();
    }
    value
}
