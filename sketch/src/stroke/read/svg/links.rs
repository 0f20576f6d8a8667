//! A picture without the parts that its shapes only point to.
//!
//! Clips, masks, markers, patterns and filters are reached through `url(#name)`. They hold no outlines for us, but
//! can refer to each other, so that a page of text stands for billions of them. Links are taken out of the text,
//! place by place, before anybody follows them.

use std::borrow::Cow;

/// What begins a link.
const LINK: &str = "url(";

/// The text without links: what they fill or draw is black, and nothing is clipped, masked, marked or filtered.
/// Everything else stays where it is. **Cost:** linear.
pub(super) fn without_links(text: &str) -> Cow<'_, str> {
    let mut plain = String::new();
    let mut rest = text;
    while let Some(start) = find(rest) {
        let Some(length) = rest[start..].find(')').map(|end| end + 1) else { break };
        let (before, link) = (&rest[..start], &rest[start..start + length]);
        plain.push_str(before);
        plain.push_str(if is_paint(before) { "#000" } else { "none" });
        // Lines and columns of errors stay what they are.
        plain.extend(link.chars().skip(4).map(|c| if c == '\n' { '\n' } else { ' ' }));
        rest = &rest[start + length..];
    }
    if plain.is_empty() {
        return Cow::Borrowed(text);
    }
    plain.push_str(rest);
    Cow::Owned(plain)
}

/// Whether an attribute's value still has a link, written so that [`without_links`] cannot see it.
pub(super) fn has_link(value: &str) -> bool {
    find(value).is_some()
}

/// Where a link begins, in letters of either case.
fn find(text: &str) -> Option<usize> {
    text.as_bytes().windows(LINK.len()).position(|window| window.eq_ignore_ascii_case(LINK.as_bytes()))
}

/// Whether what stands before a value says that it is a colour.
fn is_paint(before: &str) -> bool {
    let property =
        before.trim_end_matches(|c: char| c.is_whitespace() || matches!(c, '"' | '\'' | ':' | '='));
    property.ends_with("fill") || property.ends_with("stroke")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_become_black_paint_or_nothing_and_all_else_stays_in_place() {
        let text = "<a style=\"fill: url(#p)\" stroke = 'URL(\n#q)' mask=\"url(#m) \"/>url(";
        let plain = "<a style=\"fill: #000   \" stroke = '#000\n   ' mask=\"none    \"/>url(";
        assert_eq!(without_links(text), plain);
        assert_eq!(without_links("<a fill=\"red\"/>"), "<a fill=\"red\"/>");
    }
}
