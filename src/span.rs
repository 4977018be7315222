//! Places in the expanded text: what every stage says where something stands.

/// A range of bytes in the expanded text. `lo <= hi`; an empty span is a point.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Default, Debug)]
pub struct Span {
    /// First byte.
    pub lo: u32,
    /// One past the last byte.
    pub hi: u32,
}

impl Span {
    /// No place in the text: what is meant stands elsewhere.
    pub(crate) const NOWHERE: Self = Self {
        lo: u32::MAX,
        hi: u32::MAX,
    };

    /// The range `lo..hi`.
    pub fn new(lo: u32, hi: u32) -> Self {
        Self { lo, hi }
    }

    /// The smallest span that covers both.
    pub fn to(self, other: Span) -> Span {
        Span {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
        }
    }
}
