use super::super::Arrow;

/// An arrow with a label at its tip.
pub struct LabeledArrow {
    /// The arrow.
    pub arrow: Arrow,
    /// The label as markup for [`super::super::text::Line::math`]; none if empty.
    pub label: String,
}

impl From<Arrow> for LabeledArrow {
    fn from(arrow: Arrow) -> LabeledArrow {
        LabeledArrow { arrow, label: String::new() }
    }
}
