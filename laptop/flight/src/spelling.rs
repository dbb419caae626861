//! Texts of users in comments of generated files, and in messages.

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

/// Returns a text of a message on one line, without letters that control a terminal, are invisible or change the
/// direction of what follows: these are escaped as in Rust. Accents that join a letter stay, as in names of files.
pub fn visible(text: &str) -> String {
    let mut line = String::new();
    for letter in text.chars() {
        match letter {
            '"' | '\'' | '\\' => line.push(letter),
            // An accent is escaped at the beginning of a text alone.
            letter => line.extend(format!("-{letter}").escape_debug().skip(1)),
        }
    }
    line
}
