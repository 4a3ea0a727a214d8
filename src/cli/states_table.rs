use crate::text::counted;
use csv::StringRecord;
use std::collections::BTreeMap;
use std::io::Read;

/// The states that another program has written as CSV, with the columns `step` or `time`, `name`, and some of `x`, `y`,
/// `vx` and `vy`, in any order.
#[derive(Debug)]
pub struct StatesTable {
    /// The compared columns: indices into [`FIELDS`], in ascending order.
    pub fields: Vec<usize>,
    /// Other columns, which are not compared.
    pub ignored: Vec<String>,
    /// The rows of each step, by the name of the body.
    pub steps: BTreeMap<u64, BTreeMap<String, StateRow>>,
}

/// The numbers of a state, m and m/s.
pub const FIELDS: [&str; 4] = ["x", "y", "vx", "vy"];

/// One row of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct StateRow {
    /// The line in the file, from 1.
    pub line: u64,
    /// The numbers of [`FIELDS`]; NaN in columns that the table does not have.
    pub values: [f64; 4],
    /// The number of decimals with which each number is written; `None` with an exponent.
    pub decimals: [Option<usize>; 4],
}

/// The reason why a table cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file cannot be read.
    #[error("{0}")]
    Unreadable(#[from] std::io::Error),
    /// A line is not text.
    #[error("line {line} is not UTF-8 text; write the table in UTF-8")]
    NotText {
        /// The line, from 1.
        line: u64,
    },
    /// A row does not have the columns of the first line.
    #[error("line {line} has {}, but the first line has {columns}{}", counted(*fields, "field"), cause(*is_last))]
    Row {
        /// The line, from 1.
        line: u64,
        /// Its number of fields.
        fields: u64,
        /// The number of columns.
        columns: u64,
        /// True if the file ends with this line, and without a line feed.
        is_last: bool,
    },
    /// The file is very long.
    #[error("the table is longer than {} MiB", MAX_BYTES >> 20)]
    TooLong,
    /// The file is empty or has no header.
    #[error("the table is empty; its first line names the columns: step,name,x,y,vx,vy")]
    Empty,
    /// The first line has numbers.
    #[error("the first line of the table is a row; begin it with the names of the columns: step,name,x,y,vx,vy")]
    NoHeader,
    /// A necessary column is missing.
    #[error("the table has no column {column}; its columns are {found}")]
    NoColumn {
        /// The missing column.
        column: &'static str,
        /// The columns of the file.
        found: String,
    },
    /// A column occurs twice.
    #[error("the table has two columns {0:?}")]
    TwoColumns(String),
    /// A field is not a value of its column.
    #[error("line {line}: {column} is {found:?}; expected {expected}")]
    Field {
        /// The line, from 1.
        line: u64,
        /// The column.
        column: String,
        /// The field.
        found: String,
        /// A description of the accepted values.
        expected: &'static str,
    },
    /// Two rows are about the same body and step.
    #[error("lines {} and {} are both about the body {name:?} at step {step}", lines[0], lines[1])]
    TwoRows {
        /// The lines, from 1.
        lines: [u64; 2],
        /// The body.
        name: String,
        /// The step.
        step: u64,
    },
}

/// The cause of a row with another number of fields than columns, and what to do.
const fn cause(is_last: bool) -> &'static str {
    if is_last {
        "; the file ends there, so it may have been cut: write it again"
    } else {
        "; write one field for each column, and quotation marks around a name that contains the separator"
    }
}

impl TableError {
    /// The error of a file whose text ends with `text`.
    fn new(error: csv::Error, text: &[u8]) -> TableError {
        let line = |position: &Option<csv::Position>| position.as_ref().map_or(1, csv::Position::line);
        match error.into_kind() {
            csv::ErrorKind::Io(error) => TableError::Unreadable(error),
            csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
                let rest = pos.as_ref().map_or(text, |pos| text.get(pos.byte() as usize..).unwrap_or_default());
                let is_last = !rest.contains(&b'\n');
                TableError::Row { line: line(&pos), fields: len, columns: expected_len, is_last }
            }
            csv::ErrorKind::Utf8 { pos, .. } => TableError::NotText { line: line(&pos) },
            other => TableError::Unreadable(std::io::Error::other(format!("{other:?}"))),
        }
    }
}

/// The largest size of a table, bytes; it is read into memory, because its rows may have any order.
const MAX_BYTES: u64 = 1 << 30;

impl StatesTable {
    /// Reads a table. A column `time` (s) stands for `step` at `rate` steps per second. Fields are separated by commas,
    /// or by the semicolons or tabs that the first line contains instead.
    pub fn read(file: impl Read, rate: f64) -> Result<StatesTable, TableError> {
        let mut text = Vec::new();
        file.take(MAX_BYTES + 1).read_to_end(&mut text)?;
        if text.len() as u64 > MAX_BYTES {
            return Err(TableError::TooLong);
        }
        let header = text.split(|byte| *byte == b'\n').next().unwrap_or_default();
        let is_separator = |byte: &u8| !header.contains(&b',') && header.contains(byte);
        let delimiter = [b';', b'\t'].into_iter().find(is_separator).unwrap_or(b',');
        let text = text.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&text);
        // A name may begin or end with a space, unless the separators of the table are followed by spaces.
        let has_spaces = header.windows(2).any(|pair| pair == [delimiter, b' ']);
        let trim = if has_spaces { csv::Trim::All } else { csv::Trim::Headers };
        let mut reader = csv::ReaderBuilder::new().delimiter(delimiter).trim(trim).from_reader(text);
        let refused = |error| TableError::new(error, text);
        let columns = Columns::find(reader.headers().map_err(refused)?)?;
        let mut steps: BTreeMap<u64, BTreeMap<String, StateRow>> = BTreeMap::new();
        for record in reader.records() {
            let (step, name, row) = columns.row(&record.map_err(refused)?, rate)?;
            let line = row.line;
            if let Some(earlier) = steps.entry(step).or_default().insert(name.clone(), row) {
                return Err(TableError::TwoRows { lines: [earlier.line, line], name, step });
            }
        }
        let fields = (0..FIELDS.len()).filter(|field| columns.fields[*field].is_some()).collect();
        Ok(StatesTable { fields, ignored: columns.ignored, steps })
    }

    /// A description of the compared columns, such as `x, y, vx, vy`.
    pub fn field_names(&self) -> String {
        self.fields.iter().map(|field| FIELDS[*field]).collect::<Vec<&str>>().join(", ")
    }
}

/// The position of each column in a row.
struct Columns {
    step: Option<usize>,
    time: Option<usize>,
    name: usize,
    fields: [Option<usize>; 4],
    ignored: Vec<String>,
}

impl Columns {
    fn find(header: &StringRecord) -> Result<Columns, TableError> {
        let names: Vec<String> = header.iter().map(str::to_lowercase).collect();
        if names.iter().all(String::is_empty) {
            return Err(TableError::Empty);
        }
        let position = |column: &str| names.iter().position(|name| name == column);
        let missing = |column| TableError::NoColumn { column, found: names.join(", ") };
        let (step, time) = (position("step"), position("time"));
        let has_time = step.or(time).is_some();
        if !has_time && names.iter().any(|name| name.parse::<f64>().is_ok()) {
            return Err(TableError::NoHeader);
        }
        if let Some((_, twice)) = names.iter().enumerate().find(|(index, name)| names[..*index].contains(name)) {
            return Err(TableError::TwoColumns(twice.clone()));
        }
        if !has_time {
            return Err(missing("step"));
        }
        let fields = FIELDS.map(position);
        if fields.iter().all(Option::is_none) {
            return Err(missing("x, y, vx or vy"));
        }
        let is_known = |name: &str| ["step", "time", "name"].contains(&name) || FIELDS.contains(&name);
        let ignored = names.iter().filter(|name| !is_known(name)).cloned().collect();
        Ok(Columns { step, time, name: position("name").ok_or_else(|| missing("name"))?, fields, ignored })
    }

    /// The step, the name and the numbers of a row.
    fn row(&self, record: &StringRecord, rate: f64) -> Result<(u64, String, StateRow), TableError> {
        let line = record.position().map_or(0, csv::Position::line);
        let invalid = |column: &str, found: &str, expected| {
            let found = found.chars().take(100).collect();
            TableError::Field { line, column: column.to_owned(), found, expected }
        };
        let number = |text: &str| text.trim().parse::<f64>().ok();
        let whole = |number: f64| (number >= 0.0 && number.fract() == 0.0 && number < 9e15).then_some(number as u64);
        let (column, index) = match (self.step, self.time) {
            (Some(step), _) => ("step", step),
            (None, time) => ("time", time.unwrap_or_default()),
        };
        let step = match number(&record[index]) {
            Some(step) if column == "step" => whole(step),
            Some(time) => whole((time * rate).round()).filter(|step| (time * rate - *step as f64).abs() < 0.1),
            None => None,
        };
        let step =
            step.ok_or_else(|| invalid(column, &record[index], "the number of a step, 0 or more, or its time in s"))?;
        let is_at = |time: f64| (time * rate - step as f64).abs() < 0.1;
        if let (Some(_), Some(time)) = (self.step, self.time)
            && !number(&record[time]).is_some_and(is_at)
        {
            let expected = "the time of the step in s, or no column time";
            return Err(invalid("time", &record[time], expected));
        }
        let mut row = StateRow { line, values: [f64::NAN; 4], decimals: [None; 4] };
        for (field, column) in self.fields.iter().enumerate().filter_map(|(field, column)| Some((field, (*column)?))) {
            let text = record[column].trim();
            row.values[field] = number(text).ok_or_else(|| invalid(FIELDS[field], text, "a number"))?;
            let has_exponent = text.contains(['e', 'E']);
            row.decimals[field] = (!has_exponent).then(|| text.split_once('.').map_or(0, |(_, digits)| digits.len()));
        }
        Ok((step, record[self.name].to_owned(), row))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<StatesTable, String> {
        StatesTable::read(text.as_bytes(), 60.0).map_err(|error| error.to_string())
    }

    #[test]
    fn rows_and_columns_have_any_order_and_columns_may_be_missing() {
        let table = read("vx,Name,step,mood\n2.50,c,1,good\n-1e3,\"a,b\",0,\n-0,c,0.0,bad\n").unwrap();
        assert_eq!((table.field_names().as_str(), table.ignored.as_slice()), ("vx", ["mood".to_owned()].as_slice()));
        assert_eq!(table.steps[&1]["c"].values[2], 2.5);
        assert_eq!((table.steps[&1]["c"].decimals[2], table.steps[&0]["a,b"].decimals[2]), (Some(2), None));
        assert_eq!((table.steps[&0]["c"].line, table.steps[&0].len()), (4, 2));
        let by_time = read("\u{feff}time;name;x\r\n0.016666666666666666;c;1.5\r\n").unwrap();
        assert_eq!(by_time.steps[&1]["c"].values[0], 1.5);
        assert_eq!(read("step,name,x\n").unwrap().steps.len(), 0);
        let spaces = read("step,name,x\n0,a, 1\n0,a ,2 \n").unwrap();
        assert_eq!((spaces.steps[&0]["a"].values[0], spaces.steps[&0]["a "].values[0]), (1.0, 2.0));
        assert_eq!(spaces.steps[&0]["a "].decimals[0], Some(0));
        assert!(read("step, name, x\n0, a, 1\n").unwrap().steps[&0].contains_key("a"));
    }

    #[test]
    fn a_table_that_cannot_be_compared_is_refused_with_its_line() {
        let cases = [
            ("", "the table is empty"),
            ("name,x\nc,1\n", "no column step; its columns are name, x"),
            ("step,x\n0,1\n", "no column name"),
            ("step,name\n0,c\n", "no column x, y, vx or vy"),
            ("step,name,x,X\n0,c,1,1\n", "two columns \"x\""),
            ("step,name,x\n0,c,1\n1,c,undefined\n", "line 3: x is \"undefined\"; expected a number"),
            ("step,name,x\n-1,c,1\n", "line 2: step is \"-1\""),
            ("step,name,x\n1.5,c,1\n", "line 2: step is \"1.5\""),
            ("time,name,x\n0.01,c,1\n", "line 2: time is \"0.01\""),
            ("step,time,name,x\n60,1.0,c,1\n120,1.0,c,1\n", "line 3: time is \"1.0\"; expected the time of the step"),
            ("0,a,1.0,2.0,0.0,0.0\n", "the first line of the table is a row"),
            ("step,name,x\n0,c,1\n0,c,2\n", "lines 2 and 3 are both about the body \"c\" at step 0"),
            ("step,name,x\n0,c\n0,b,1\n", "line 2 has 2 fields, but the first line has 3; write one field for each"),
            ("step,name,x\n0,c,1,2\n", "line 2 has 4 fields, but the first line has 3; write one field for each"),
            ("step,name,x\n0,c,1\n1,c", "line 3 has 2 fields, but the first line has 3; the file ends there"),
            ("step,name,x\n0,c,1\n1", "line 3 has 1 field, but the first line has 3; the file ends there"),
        ];
        for (text, message) in cases {
            let error = read(text).unwrap_err();
            assert!(error.contains(message), "{text:?}: {error}");
        }
    }

    #[test]
    fn a_table_that_is_not_text_is_refused_with_its_line() {
        for (bytes, line) in [
            (b"step,name,x\n0,c,1\n1,\xe9,1\n".as_slice(), 3),
            (b"step,n\xe9,x\n0,c,1\n", 1),
            (b"\xff\xfes\0t\0e\0p\0", 1),
        ] {
            let error = StatesTable::read(bytes, 60.0).unwrap_err().to_string();
            assert_eq!(error, format!("line {line} is not UTF-8 text; write the table in UTF-8"));
        }
    }
}
