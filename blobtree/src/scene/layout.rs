//! Lines and indentation for JSON text: whatever fits on one line stays on one.

/// Longest line that is made by putting values side by side, without its indentation: a primitive deep in a
/// tree is as easy to read as one at the top.
const WIDTH: usize = 100;

/// Lays out JSON text that has no spaces outside strings. Ends in a line break.
///
/// Cost: linear in the text.
pub(super) fn lay_out(compact: &str) -> String {
    let widths = widths(compact);
    let mut next_width = widths.iter();
    let mut out = String::with_capacity(compact.len() * 2);
    let mut line_start = 0;
    // For each open bracket, whether its items stand on lines of their own.
    let mut open: Vec<bool> = Vec::new();
    for (byte, in_string, piece) in pieces(compact) {
        if in_string {
            out.push_str(piece);
            continue;
        }
        let broken = open.last() == Some(&true);
        match byte {
            b'{' | b'[' => {
                let width = *next_width.next().expect("every opening bracket was measured");
                let flat = open.last() == Some(&false) || out.len() - line_start + width <= WIDTH;
                out.push_str(piece);
                open.push(!flat);
                if !flat {
                    line_start = break_line(&mut out, open.len());
                }
            }
            b'}' | b']' => {
                open.pop();
                if broken {
                    line_start = break_line(&mut out, open.len());
                }
                out.push_str(piece);
            }
            b',' => {
                out.push(',');
                if broken {
                    line_start = break_line(&mut out, open.len());
                } else {
                    out.push(' ');
                }
            }
            b':' => out.push_str(": "),
            _ => out.push_str(piece),
        }
    }
    out.push('\n');
    out
}

/// Returns where the new line's text starts.
fn break_line(out: &mut String, indent: usize) -> usize {
    out.push('\n');
    out.extend(std::iter::repeat_n("  ", indent));
    out.len()
}

/// The width of every bracketed value, on one line, in the order of their opening brackets.
fn widths(compact: &str) -> Vec<usize> {
    let (mut widths, mut open) = (Vec::new(), Vec::new());
    let mut at = 0;
    for (byte, in_string, piece) in pieces(compact) {
        let spaced = !in_string && matches!(byte, b',' | b':');
        at += piece.len() + usize::from(spaced);
        if in_string {
            continue;
        }
        match byte {
            b'{' | b'[' => {
                open.push((widths.len(), at - 1));
                widths.push(0);
            }
            b'}' | b']' => {
                let (index, start) = open.pop().expect("brackets match in JSON");
                widths[index] = at - start;
            }
            _ => {}
        }
    }
    widths
}

/// The text cut at its characters outside strings, each string being one piece; with the first byte of the
/// piece and whether it is a string.
fn pieces(compact: &str) -> impl Iterator<Item = (u8, bool, &str)> {
    let bytes = compact.as_bytes();
    let mut at = 0;
    std::iter::from_fn(move || {
        let start = at;
        let first = *bytes.get(at)?;
        at += 1;
        if first == b'"' {
            while bytes.get(at).is_some_and(|&b| b != b'"') {
                at += if bytes[at] == b'\\' { 2 } else { 1 };
            }
            at += 1;
        }
        Some((first, first == b'"', &compact[start..at]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_values_share_a_line_and_long_ones_are_broken_outside_in() {
        let long = "x".repeat(60);
        let compact = format!(r#"{{"a":[1,2],"b":{{"c":"{long}","d":"[\",:{{"}},"e":[{{}},[]]}}"#);
        let expected = format!(
            "{{\n  \"a\": [1, 2],\n  \"b\": {{\"c\": \"{long}\", \"d\": \"[\\\",:{{\"}},\n  \"e\": [{{}}, []]\n}}\n"
        );
        assert_eq!(lay_out(&compact), expected);
        assert_eq!(lay_out(r#"{"a":[1,2]}"#), "{\"a\": [1, 2]}\n");
    }
}
