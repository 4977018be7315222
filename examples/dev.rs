//! temporary
use bmod::host::*;
use std::path::*;
struct H(std::time::Instant);
impl Host for H {
    fn read(&mut self, p: &str, from: Option<&Path>) -> Result<(PathBuf, String), HostError> {
        let mut c = vec![PathBuf::from(p)];
        if let Some(f) = from {
            c.insert(0, f.parent().unwrap().join(p));
        }
        for q in c {
            if q.exists() {
                let b = std::fs::read(&q).unwrap();
                return String::from_utf8(b)
                    .map(|t| (q, t))
                    .map_err(|e| HostError::NotUtf8(e.utf8_error().valid_up_to()));
            }
        }
        Err(HostError::NotFound)
    }
    fn exists(&mut self, p: &str, _: Option<&Path>) -> bool {
        Path::new(p).exists()
    }
    fn write(&mut self, p: &str, b: &[u8]) -> Result<PathBuf, HostError> {
        std::fs::write(p, b).unwrap();
        Ok(p.into())
    }
    fn print(&mut self, t: &str) {
        print!("{t}")
    }
    fn elapsed(&self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
    fn now(&self) -> f64 {
        45000.0
    }
    fn interrupted(&self) -> bool {
        false
    }
    fn solved(&mut self, s: &bmod::report::json::Solve) {
        println!("{}", serde_json::to_string(s).unwrap())
    }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut h = H(std::time::Instant::now());
    let f = bmod::session::run(
        &mut h,
        &a[1],
        bmod::source::PreprocessOptions {
            defines: vec![("BMOD".into(), "1".into())],
            slash_comments: a[1].ends_with("blk"),
        },
        Default::default(),
        false,
        &mut |_| {},
    );
    for d in &f.diagnostics {
        println!(
            "{} line {} {:?}: {} [{}] {:?}",
            d.code,
            f.map.line(d.span),
            d.severity,
            d.message,
            d.label,
            d.help
        );
    }
    println!(
        "exit {} {:.3}",
        f.end.exit_status(),
        h.0.elapsed().as_secs_f64()
    );
}
