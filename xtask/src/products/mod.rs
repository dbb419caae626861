//! What others use of this repository: the C library, the Python package, the page, the book, firmware
//! for a board.

pub mod book;
pub mod c_library;
pub mod new_firmware;
pub mod new_scheme;
pub mod page;
pub mod parts;
pub mod python_package;
pub mod templates;
