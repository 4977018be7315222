//! Bytes of a GDX file: numbers, strings, and blocks packed by zlib.

use super::{Result, fail};

/// Most bytes of a block before it is packed.
const BLOCK: usize = 32 * 1024;

/// Reads a part of a file, packed or not.
pub(super) struct Input<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Bytes of the present block, and how many of them were read; none if the part is not packed.
    block: Option<(Vec<u8>, usize)>,
}

impl<'a> Input<'a> {
    /// The part that begins at a place.
    pub(super) fn new(bytes: &'a [u8], at: i64, packed: bool) -> Result<Self> {
        match usize::try_from(at) {
            Ok(at) if at < bytes.len() => Ok(Self {
                bytes,
                at,
                block: packed.then(|| (Vec::new(), 0)),
            }),
            _ => fail(format!("byte {at} is referred to, of {}", bytes.len())),
        }
    }

    fn plain(&mut self, n: usize) -> Result<&'a [u8]> {
        match self.bytes.get(self.at..).and_then(|rest| rest.get(..n)) {
            Some(taken) => {
                self.at += n;
                Ok(taken)
            }
            None => fail("the file ends too early"),
        }
    }

    /// The next block.
    fn unpack(&mut self) -> Result<()> {
        let at = self.at;
        let head = self.plain(3)?;
        let (packed, len) = (head[0], usize::from(head[1]) << 8 | usize::from(head[2]));
        let body = self.plain(len)?;
        let block = match packed {
            0 => body.to_vec(),
            1 => miniz_oxide::inflate::decompress_to_vec_zlib_with_limit(body, 2 * BLOCK)
                .unwrap_or_default(),
            _ => Vec::new(),
        };
        if block.is_empty() {
            return fail(format!("the packed block at byte {at} is damaged"));
        }
        self.block = Some((block, 0));
        Ok(())
    }

    fn fill(&mut self, out: &mut [u8]) -> Result<()> {
        let mut done = 0;
        while done < out.len() {
            let Some((block, read)) = &mut self.block else {
                let n = out.len();
                out.copy_from_slice(self.plain(n)?);
                return Ok(());
            };
            let n = (block.len() - *read).min(out.len() - done);
            if n == 0 {
                self.unpack()?;
                continue;
            }
            out[done..done + n].copy_from_slice(&block[*read..*read + n]);
            *read += n;
            done += n;
        }
        Ok(())
    }

    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut out = [0; N];
        self.fill(&mut out)?;
        Ok(out)
    }

    pub(super) fn byte(&mut self) -> Result<u8> {
        Ok(self.array::<1>()?[0])
    }

    pub(super) fn u16(&mut self) -> Result<u16> {
        Ok(u16::from_le_bytes(self.array()?))
    }

    pub(super) fn i32(&mut self) -> Result<i32> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    pub(super) fn i64(&mut self) -> Result<i64> {
        Ok(i64::from_le_bytes(self.array()?))
    }

    pub(super) fn f64(&mut self) -> Result<f64> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    /// A length and as many bytes. What is not UTF-8 was written under an older code page: Latin-1.
    pub(super) fn text(&mut self) -> Result<String> {
        let len = usize::from(self.byte()?);
        let mut bytes = vec![0; len];
        self.fill(&mut bytes)?;
        Ok(String::from_utf8(bytes)
            .unwrap_or_else(|e| e.into_bytes().into_iter().map(char::from).collect()))
    }

    /// A mark that must stand here.
    pub(super) fn mark(&mut self, mark: &str) -> Result<()> {
        match self.text()? {
            t if t == mark => Ok(()),
            _ => fail(format!("the mark `{mark}` is not where it should be")),
        }
    }

    /// A count of something that takes at least a byte each.
    pub(super) fn count(&mut self, what: &str) -> Result<usize> {
        let n = self.i32()?;
        match usize::try_from(n) {
            Ok(n) => Ok(n),
            Err(_) => fail(format!("the number of {what} is {n}")),
        }
    }
}

/// Writes the parts of a file.
#[derive(Default)]
pub(super) struct Output {
    pub bytes: Vec<u8>,
}

impl Output {
    /// Where the next part begins.
    pub(super) fn place(&self) -> i64 {
        self.bytes.len() as i64
    }

    pub(super) fn raw(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    pub(super) fn byte(&mut self, b: u8) {
        self.raw(&[b]);
    }

    pub(super) fn i32(&mut self, n: i32) {
        self.raw(&n.to_le_bytes());
    }

    pub(super) fn i64(&mut self, n: i64) {
        self.raw(&n.to_le_bytes());
    }

    pub(super) fn f64(&mut self, x: f64) {
        self.raw(&x.to_le_bytes());
    }

    /// A text of at most 255 bytes; what is longer is cut.
    pub(super) fn text(&mut self, t: &str) {
        let mut len = t.len().min(255);
        while !t.is_char_boundary(len) {
            len -= 1;
        }
        self.byte(len as u8);
        self.raw(&t.as_bytes()[..len]);
    }
}
