use std::ops::Range;

use super::Fault;

/// A fault and where in the text it stands: what reading gives up with.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    pub fault: Box<Fault>,
    /// The bytes to underline.
    pub span: Range<usize>,
    /// The bytes it clashes with, if it does.
    pub earlier: Option<Range<usize>>,
}

impl Refusal {
    /// The refusal of what stands at `span`.
    pub fn new(fault: Fault, span: Range<usize>) -> Refusal {
        Refusal { fault: Box::new(fault), span, earlier: None }
    }

    /// The same, because of what stands at `earlier`.
    pub fn after(self, earlier: Range<usize>) -> Refusal {
        Refusal { earlier: Some(earlier), ..self }
    }
}
