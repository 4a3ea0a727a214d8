//! JUnit reports, which CI systems and marking tools read.
//!
//! The crate quick-junit gives `testsuites` attributes that the schema of Ant does not allow, and brings an XML writer
//! and a calendar along. These three elements need none of it.

use crate::text::Escaped;
use std::fmt::{self, Display, Formatter};

/// A suite of test cases: the file of one command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TestSuite {
    /// The name of the suite.
    pub name: String,
    /// The cases, in their order.
    pub cases: Vec<TestCase>,
}

/// One test case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TestCase {
    /// The group of the case; CI systems show it as the name of a class.
    pub class: String,
    /// The name of the case.
    pub name: String,
    /// The result.
    pub outcome: TestOutcome,
}

/// The result of a test case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TestOutcome {
    /// The case is as expected.
    Passed,
    /// The case differs from the expectation.
    Failed {
        /// One line.
        message: String,
        /// All that is known about the difference.
        details: String,
    },
    /// The case could not be carried out.
    Error {
        /// One line.
        message: String,
    },
}

impl TestSuite {
    fn count(&self, is_counted: impl Fn(&TestOutcome) -> bool) -> usize {
        self.cases.iter().filter(|case| is_counted(&case.outcome)).count()
    }
}

/// Formats the suite as a document that is valid in the schemas of Jenkins and of Ant, between which readers of JUnit
/// reports are divided. Both require times; these are constant, so that the same results give the same bytes.
impl Display for TestSuite {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        let failures = self.count(|outcome| matches!(outcome, TestOutcome::Failed { .. }));
        let errors = self.count(|outcome| matches!(outcome, TestOutcome::Error { .. }));
        let (name, tests) = (Escaped(&self.name), self.cases.len());
        writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>")?;
        writeln!(
            out,
            "  <testsuite name=\"{name}\" package=\"rebond\" id=\"0\" tests=\"{tests}\" failures=\"{failures}\" \
             errors=\"{errors}\" time=\"0\" timestamp=\"2000-01-01T00:00:00\" hostname=\"localhost\">\n    <properties/>"
        )?;
        self.cases.iter().try_for_each(|case| case.fmt(out))?;
        writeln!(out, "    <system-out/>\n    <system-err/>\n  </testsuite>\n</testsuites>")
    }
}

/// Formats the case as an element of its suite.
impl Display for TestCase {
    fn fmt(&self, out: &mut Formatter) -> fmt::Result {
        let (class, name) = (Escaped(&self.class), Escaped(&self.name));
        write!(out, "    <testcase classname=\"{class}\" name=\"{name}\" time=\"0\"")?;
        match &self.outcome {
            TestOutcome::Passed => writeln!(out, "/>"),
            TestOutcome::Failed { message, details } => {
                let (message, details) = (Escaped(message), Escaped(details));
                writeln!(
                    out,
                    ">\n      <failure type=\"difference\" message=\"{message}\">{details}</failure>\n    </testcase>"
                )
            }
            TestOutcome::Error { message } => {
                let message = Escaped(message);
                writeln!(out, ">\n      <error type=\"error\" message=\"{message}\"/>\n    </testcase>")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_suite_counts_its_cases_and_escapes_their_texts() {
        let case = |name: &str, outcome| TestCase { class: "a&b".into(), name: name.into(), outcome };
        let failed = TestOutcome::Failed { message: "x < \"y\"\u{1b}".into(), details: "line 1\nline 2".into() };
        let cases = vec![
            case("same", TestOutcome::Passed),
            case("other", failed),
            case("none", TestOutcome::Error { message: "cannot read".into() }),
        ];
        let expected = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
                        <testsuites>\n  \
                          <testsuite name=\"rebond check\" package=\"rebond\" id=\"0\" tests=\"3\" failures=\"1\" \
                            errors=\"1\" time=\"0\" timestamp=\"2000-01-01T00:00:00\" hostname=\"localhost\">\n    \
                            <properties/>\n    \
                            <testcase classname=\"a&amp;b\" name=\"same\" time=\"0\"/>\n    \
                            <testcase classname=\"a&amp;b\" name=\"other\" time=\"0\">\n      \
                              <failure type=\"difference\" message=\"x &lt; &quot;y&quot;\">line 1\nline 2</failure>\n    \
                            </testcase>\n    \
                            <testcase classname=\"a&amp;b\" name=\"none\" time=\"0\">\n      \
                              <error type=\"error\" message=\"cannot read\"/>\n    \
                            </testcase>\n    \
                            <system-out/>\n    \
                            <system-err/>\n  \
                          </testsuite>\n\
                        </testsuites>\n";
        assert_eq!(TestSuite { name: "rebond check".into(), cases }.to_string(), expected);
    }
}
