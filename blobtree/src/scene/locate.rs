//! Finds the place in the text of a value that turned out wrong.

use super::error::TextPosition;

/// One step from a JSON value to a value in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// To the value of a key.
    Key(String),
    /// To an item of a list.
    Index(usize),
}

impl Step {
    pub(super) fn key(key: &str) -> Self {
        Self::Key(key.into())
    }
}

/// Where in `text`, which is JSON, the value starts to which `steps` lead; if they lead nowhere, the value
/// where they part from the text.
pub(super) fn position(text: &str, steps: &[Step]) -> TextPosition {
    let mut cursor = Cursor { bytes: text.as_bytes(), at: 0 };
    cursor.skip_space();
    for step in steps {
        let whole = cursor.at;
        let found = match step {
            Step::Key(key) => cursor.enter_object(key),
            Step::Index(index) => cursor.enter_list(*index),
        };
        if !found {
            cursor.at = whole;
            break;
        }
    }
    TextPosition::of_offset(text.as_bytes(), cursor.at)
}

/// The node to which `steps` belong, as a path like `/0/2` or `define.leg/1`; `None` outside any node.
pub(super) fn node_label(steps: &[Step]) -> Option<String> {
    let (mut label, mut rest) = match steps {
        [Step::Key(root), rest @ ..] if root == "root" || root == "node" => (String::new(), rest),
        [Step::Key(define), Step::Key(name), rest @ ..] if define == "define" => {
            (format!("define.{}", super::error::shortened(name)), rest)
        }
        _ => return None,
    };
    loop {
        match rest {
            [Step::Key(children), Step::Index(index), more @ ..] if children == "children" => {
                label += &format!("/{index}");
                rest = more;
            }
            [Step::Key(child), more @ ..] if child == "child" => {
                label += "/0";
                rest = more;
            }
            _ => break,
        }
    }
    Some(if label.is_empty() { "/".into() } else { label })
}

/// A reading position in JSON text. Stays in the text whatever it holds.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Cursor<'_> {
    fn peek(&self) -> u8 {
        self.bytes.get(self.at).copied().unwrap_or(0)
    }

    fn skip_space(&mut self) {
        while self.peek().is_ascii_whitespace() {
            self.at += 1;
        }
    }

    /// Skips `byte` and the space around it, if it is next.
    fn skip(&mut self, byte: u8) -> bool {
        self.skip_space();
        let there = self.peek() == byte;
        if there {
            self.at += 1;
            self.skip_space();
        }
        there
    }

    fn skip_string(&mut self) {
        self.at += 1;
        while self.at < self.bytes.len() && self.peek() != b'"' {
            self.at += if self.peek() == b'\\' { 2 } else { 1 };
        }
        self.at = (self.at + 1).min(self.bytes.len());
    }

    fn skip_value(&mut self) {
        let mut depth = 0_usize;
        while self.at < self.bytes.len() {
            match self.peek() {
                b'"' => {
                    self.skip_string();
                    continue;
                }
                b'{' | b'[' => depth += 1,
                b'}' | b']' | b',' if depth == 0 => return,
                b'}' | b']' => depth -= 1,
                _ => {}
            }
            self.at += 1;
        }
    }

    fn enter_object(&mut self, key: &str) -> bool {
        if !self.skip(b'{') {
            return false;
        }
        while self.peek() == b'"' {
            let start = self.at;
            self.skip_string();
            let this = serde_json::from_slice::<String>(&self.bytes[start..self.at]);
            if !self.skip(b':') {
                return false;
            }
            if this.is_ok_and(|this| this == key) {
                return true;
            }
            self.skip_value();
            self.skip(b',');
        }
        false
    }

    fn enter_list(&mut self, index: usize) -> bool {
        if !self.skip(b'[') {
            return false;
        }
        for _ in 0..index {
            self.skip_value();
            if !self.skip(b',') {
                return false;
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_found_behind_escaped_keys_nested_lists_and_letters_of_several_bytes() {
        let text = "{ \"a]\\\"\": [1, {\"x\": \"}\"}],\n  \"é\": {\"\\u0062\": [[], 7]}}";
        let steps = [Step::key("é"), Step::key("b"), Step::Index(1)];
        assert_eq!(position(text, &steps), TextPosition { line: 2, column: 24 });
        assert_eq!(position(text, &steps[..1]), TextPosition { line: 2, column: 8 });
        let nowhere = [Step::key("é"), Step::key("c"), Step::Index(1)];
        assert_eq!(position(text, &nowhere), TextPosition { line: 2, column: 8 });
    }

    #[test]
    fn a_text_that_is_not_json_never_moves_the_cursor_out_of_it() {
        for text in ["", "{", "[", "{\"", "{\"a\\", "{\"a\":", "[1,", "\"", "]", "{\"a\" 1}"] {
            for steps in [[Step::key("a"), Step::Index(0)], [Step::Index(1), Step::key("a")]] {
                assert_eq!(position(text, &steps).line, 1, "{text}");
            }
        }
    }
}
