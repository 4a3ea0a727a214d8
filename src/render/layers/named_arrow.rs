use super::super::Arrow;

/// An arrow, and what is written beside it.
pub struct NamedArrow {
    /// The arrow.
    pub arrow: Arrow,
    /// Markup for [`super::super::text::Line::math`]; empty for nothing.
    pub name: String,
}

impl From<Arrow> for NamedArrow {
    fn from(arrow: Arrow) -> NamedArrow {
        NamedArrow { arrow, name: String::new() }
    }
}
