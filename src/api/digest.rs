//! Runs told apart by a short text.

use super::{Model, Options, host};
use crate::check;
use crate::data::input::{Input, InputData};
use crate::solve::registry::SOLVERS;

/// FNV-1a in 128 bits (Fowler, Noll, Vo): the same everywhere and always.
struct Digest(u128);

impl Digest {
    fn new() -> Self {
        Self(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }

    /// Adds a text, told apart from the next one.
    fn add(&mut self, bytes: &[u8]) {
        const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
        let length = (bytes.len() as u64).to_le_bytes();
        for &b in length.iter().chain(bytes) {
            self.0 = (self.0 ^ u128::from(b)).wrapping_mul(PRIME);
        }
    }

    fn input(&mut self, input: &Input) {
        self.add(input.name.to_lowercase().as_bytes());
        let keys = input.data.keys();
        for p in 0..keys.dimension() {
            keys.labels(p).iter().for_each(|l| self.add(l.as_bytes()));
            let codes = keys.codes(p).iter().flat_map(|c| c.to_le_bytes());
            self.add(&codes.collect::<Vec<u8>>());
        }
        match &input.data {
            InputData::Members(_, texts) => texts.iter().for_each(|t| self.add(t.as_bytes())),
            InputData::Values(_, values) => {
                let values = values.iter().flat_map(|v| v.to_le_bytes());
                self.add(&values.collect::<Vec<u8>>());
            }
        }
    }
}

impl Model {
    /// A text that is the same for the same run: texts of the model and of what it reads when it is compiled, defines, data,
    /// options, version of bmod, and whatever else `with` has. What only the run reads (`execute_load`) is not looked at: for that
    /// see [`Model::still_reads`].
    ///
    /// ```
    /// use bmod::{Model, Options};
    ///
    /// let mut model = Model::from_text("m.blk", "Scalar n / 3 /;");
    /// let before = model.digest(&Options::default(), &[]);
    /// model.set_scalar("n", 4.0);
    /// assert_ne!(model.digest(&Options::default(), &[]), before);
    /// model.forget("n");
    /// assert_eq!(model.digest(&Options::default(), &[]), before);
    /// ```
    pub fn digest(&self, options: &Options, with: &[&str]) -> String {
        let mut d = Digest::new();
        d.add(env!("CARGO_PKG_VERSION").as_bytes());
        with.iter().for_each(|t| d.add(t.as_bytes()));
        for (name, value) in &self.defines {
            d.add(name.to_lowercase().as_bytes());
            d.add(value.as_bytes());
        }
        for (name, content) in &self.contents {
            if *name != self.name {
                d.add(name.as_bytes());
            }
            d.add(content);
        }
        for answer in self.answers(options) {
            d.add(&answer.to_le_bytes());
        }
        let mut inputs: Vec<&Input> = self.inputs.iter().map(|i| &**i).collect();
        inputs.sort_by_key(|i| i.name.to_lowercase());
        inputs.iter().for_each(|i| d.input(i));
        options.describe(&mut |text| d.add(text.as_bytes()));
        format!("{:032x}", d.0)
    }

    /// Whether the files of [`Run::reads`](crate::Run::reads) are as that run found them.
    pub fn still_reads(&self, reads: &str) -> bool {
        let options = Options::default();
        let host = host::RunHost::new(self, &options);
        let questions = serde_json::from_str::<Vec<host::Question>>(reads);
        questions.is_ok_and(|all| all.iter().all(|q| host.answers_again(q)))
    }

    /// What the disk says to what the text asks while it is compiled.
    fn answers(&self, options: &Options) -> Vec<u64> {
        let mut host = host::RunHost::new(self, options);
        let preprocess = self.preprocess(options);
        match &self.kept {
            Some(kept) => {
                let _ = kept.program(self, &mut host, preprocess);
                kept.answers(self).or_else(|| host.answers())
            }
            None => {
                let _ = check::compile(&mut host, &self.name, preprocess, &SOLVERS);
                host.answers()
            }
        }
        .unwrap_or_default()
    }
}
