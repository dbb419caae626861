//! Texts of users in comments of generated files.

/// Returns a text on one line, without letters that end a line, are invisible or change the direction of what follows:
/// these are escaped as in Rust.
pub fn escaped(text: &str) -> String {
    let mut line = String::new();
    for letter in text.chars() {
        match letter {
            '"' | '\'' | '\\' => line.push(letter),
            letter => line.extend(letter.escape_debug()),
        }
    }
    line
}
