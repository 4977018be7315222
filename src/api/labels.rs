//! Labels of a record, however a program has them.

/// Labels of a record: one text for a single index, an array, slice, vector or tuple for several, `[]` or `()` for
/// none.
///
/// ```
/// # use bmod::Labels;
/// assert_eq!("a".labels(), ["a"]);
/// assert_eq!(["a", "x"].labels(), ["a", "x"]);
/// assert_eq!(("a", String::from("x")).labels(), ["a", "x"]);
/// assert!([].labels().is_empty());
/// ```
pub trait Labels {
    /// The labels, in the order of the index positions.
    fn labels(&self) -> Vec<String>;
}

impl Labels for str {
    fn labels(&self) -> Vec<String> {
        vec![self.to_string()]
    }
}

impl Labels for String {
    fn labels(&self) -> Vec<String> {
        vec![self.clone()]
    }
}

impl<T: Labels + ?Sized> Labels for &T {
    fn labels(&self) -> Vec<String> {
        (**self).labels()
    }
}

impl<const N: usize> Labels for [&str; N] {
    fn labels(&self) -> Vec<String> {
        self.iter().map(ToString::to_string).collect()
    }
}

impl<T: AsRef<str>> Labels for [T] {
    fn labels(&self) -> Vec<String> {
        self.iter().map(|l| l.as_ref().into()).collect()
    }
}

impl<T: AsRef<str>> Labels for Vec<T> {
    fn labels(&self) -> Vec<String> {
        self.as_slice().labels()
    }
}

impl Labels for () {
    fn labels(&self) -> Vec<String> {
        Vec::new()
    }
}

impl<A: AsRef<str>, B: AsRef<str>> Labels for (A, B) {
    fn labels(&self) -> Vec<String> {
        vec![self.0.as_ref().into(), self.1.as_ref().into()]
    }
}

impl<A: AsRef<str>, B: AsRef<str>, C: AsRef<str>> Labels for (A, B, C) {
    fn labels(&self) -> Vec<String> {
        let (a, b, c) = (self.0.as_ref(), self.1.as_ref(), self.2.as_ref());
        vec![a.into(), b.into(), c.into()]
    }
}
