//! Data given from outside the text: by a program that uses the library, or by the command line.

/// Data for one symbol. They stand in place of what data statements of the text say about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// The symbol, in any case.
    pub name: String,
    /// Its data.
    pub data: InputData,
}

/// What a symbol gets.
#[derive(Clone, Debug, PartialEq)]
pub enum InputData {
    /// Members of a set: labels, and the explanatory text, perhaps empty.
    Members(Vec<(Vec<String>, String)>),
    /// Records of a parameter: labels (none for a scalar) and value.
    Values(Vec<(Vec<String>, f64)>),
}

impl InputData {
    /// Labels of the first record, if there is one.
    pub fn first(&self) -> Option<&[String]> {
        match self {
            Self::Members(list) => list.first().map(|r| &*r.0),
            Self::Values(list) => list.first().map(|r| &*r.0),
        }
    }

    /// Labels of all records, in order.
    pub fn keys(&self) -> Box<dyn Iterator<Item = &[String]> + '_> {
        match self {
            Self::Members(list) => Box::new(list.iter().map(|r| &*r.0)),
            Self::Values(list) => Box::new(list.iter().map(|r| &*r.0)),
        }
    }
}
