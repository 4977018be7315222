//! Values and derivatives of every function against 20-digit references and against GAMS's numbers.

use Function as F;
use bmod::autodiff::partials::{packed, partials};
use bmod::autodiff::{ErrorKind, function_value};
use bmod::model::instance::Function;

/// Every function with its name.
fn by_name(name: &str) -> Function {
    Function::named(name).expect(name)
}

#[test]
fn values_and_derivatives_agree_with_high_precision() {
    let mut worst: Vec<(f64, String)> = Vec::new();
    for line in include_str!("data/derivatives.csv").lines() {
        let part: Vec<&str> = line.split(',').collect();
        let numbers = |s: &str| -> Vec<f64> { s.split(' ').map(|t| t.parse().unwrap()).collect() };
        let (f, args) = (by_name(part[0]), numbers(part[1]));
        let (value, gradient, hessian) = (numbers(part[2]), numbers(part[3]), numbers(part[4]));
        let n = args.len();
        let (mut g, mut h) = (vec![0.0; n], vec![0.0; n * (n + 1) / 2]);
        let active = vec![true; n];
        let v =
            partials(f, &args, &active, &mut g, &mut h).unwrap_or_else(|e| panic!("{line}: {e}"));
        let mut compare = |what: String, got: f64, want: f64| {
            let error = if want == 0.0 {
                got.abs()
            } else {
                ((got - want) / want).abs()
            };
            worst.push((
                error,
                format!(
                    "{}({}) {what}: {got:e} instead of {want:e}",
                    part[0], part[1]
                ),
            ));
        };
        compare("value".into(), v, value[0]);
        for i in 0..n {
            compare(format!("d{i}"), g[i], gradient[i]);
            for j in 0..=i {
                compare(format!("d{i}{j}"), h[packed(i, j)], hessian[packed(i, j)]);
            }
        }
    }
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    let bad: Vec<_> = worst
        .iter()
        .filter(|w| w.0.is_nan() || w.0 > 1e-12)
        .map(|w| format!("{:.1e} {}", w.0, w.1))
        .collect();
    assert!(
        bad.is_empty(),
        "{} of {} beyond 1e-12:\n{}",
        bad.len(),
        worst.len(),
        bad.join("\n")
    );
}

/// What GAMS 54.6 gives.
#[test]
fn values_agree_with_gams() {
    #[rustfmt::skip]
    let cases: &[(Function, &[f64], f64)] = &[
        (F::Exp, &[1000.0], 1e299), (F::Exp, &[690.0], 1e299), (F::Sinh, &[-1000.0], -1e299),
        (F::Cosh, &[700.0], 1e299), (F::Sqr, &[1e200], 1e299), (F::Gamma, &[200.0], 1e299),
        (F::Gamma, &[-0.5], -3.5449077018110318), (F::Beta, &[2.0, 3.0], 0.08333333333333333),
        (F::BetaReg, &[0.3, 2.0, 3.0], 0.3483), (F::GammaReg, &[0.5, 2.0], 0.09020401043104986),
        (F::Binomial, &[5.5, 2.2], 13.411817031137325), (F::Binomial, &[5.0, 2.0], 10.0), (F::Binomial, &[2.0, 2.5], 0.3395305452627108),
        (F::Binomial, &[2000.0, 1000.0], 1e299), (F::RPower, &[0.0, 0.0], 1.0), (F::RPower, &[0.0, 0.5], 0.0),
        (F::RPower, &[10.0, 400.0], 1e299), (F::Power, &[-2.0, 3.0], -8.0), (F::Power, &[0.0, 0.0], 1.0),
        (F::Power, &[2.0, 2.000001], 4.0), (F::Power, &[10.0, 400.0], 1e299), (F::SignPower, &[-2.0, 2.0], -4.0),
        (F::SignPower, &[0.0, 0.0], 1.0), (F::SignPower, &[-2.0, 0.0], -1.0), (F::CvPower, &[0.0, -1.0], 0.0),
        (F::CvPower, &[0.0, 0.0], 0.0), (F::VcPower, &[0.0, 0.0], 1.0), (F::Entropy, &[0.0], 0.0),
        (F::Entropy, &[0.5], 0.34657359027997264), (F::Centropy, &[0.5, 0.2], 0.45814536593707755),
        (F::Centropy, &[0.0, 0.2], 0.0), (F::Logit, &[0.3], -0.8472978603872037), (F::ErrorF, &[1.0], 0.8413447460685429),
        (F::Round, &[2.5], 3.0), (F::Round, &[-2.5], -3.0), (F::Round, &[-0.4], 0.0), (F::Round, &[2.345, 2.0], 2.35),
        (F::Round, &[1234.5, -2.0], 1200.0), (F::Mod, &[-7.0, 3.0], -1.0), (F::Mod, &[7.0, -3.0], 1.0),
        (F::Trunc, &[-2.7], -2.0), (F::Frac, &[-2.25], -0.25), (F::Floor, &[-2.5], -3.0), (F::Ceil, &[-2.5], -2.0),
        (F::Poly, &[2.0, 1.0, 2.0, 3.0], 17.0), (F::EDist, &[3.0, 4.0], 5.0), (F::Div0, &[-1.0, 0.0], -1e299),
        (F::Div0, &[0.0, 0.0], 1e299), (F::SlExp, &[-200.0], 1.3838965267367376e-87), (F::SlRec, &[0.0], 2e10),
        (F::SqRec, &[0.0], 3e10), (F::SlRec, &[-1.0], 1.0000000002e20), (F::SlLog10, &[0.0], -150.43429448190326),
        (F::SqLog10, &[0.0], -150.65144172285488), (F::SqLog10, &[-1.0], -1e299), (F::NcpF, &[3.0, 4.0], -2.0),
        (F::NcpF, &[0.0, 0.0], 0.0), (F::NcpCm, &[2.0, 3.0, 1.0], 1.6867383124817772), (F::NcpVuSin, &[3.0, 4.0], 3.0),
        (F::NcpVuSin, &[1.0, 1.2, 1.0], 0.9027306914562628), (F::NcpVuPow, &[1.0, 0.5, 2.0], 0.32861328125),
        (F::LseMax, &[1.0, 2.0, 3.0], 3.4076059644443806), (F::LseMin, &[1.0, 2.0, 3.0], 0.5923940355556196),
        (F::LseMaxSc, &[2.0, 1.0, 2.0, 3.0], 3.0714658142499496), (F::LseMinSc, &[2.0, 1.0, 2.0, 3.0], 0.9285341857500504),
        (F::LseMax, &[-2000.0, -2000.0], -1999.30685281944), (F::IfThen, &[0.1, 2.0, 3.0], 2.0), (F::Sign, &[-3.0], -1.0),
        (F::BoolImp, &[0.0, 0.0], 1.0), (F::BoolXor, &[2.0, 3.0], 0.0), (F::RelLe, &[1.0, 2.0], 1.0),
        (F::Exp, &[f64::INFINITY], f64::INFINITY), (F::Tanh, &[f64::INFINITY], 1.0), (F::Max, &[1.0, f64::INFINITY], f64::INFINITY),
    ];
    for (f, args, want) in cases {
        let got = function_value(*f, args).unwrap_or_else(|e| panic!("{e}"));
        assert!(
            got == *want || (got - want).abs() <= 4e-15 * want.abs(),
            "{}{args:?} = {got:e}, not {want:e}",
            f.name()
        );
    }
}

#[test]
fn domain_errors_are_said_in_words() {
    #[rustfmt::skip]
    let cases: &[(Function, &[f64], ErrorKind, &str)] = &[
        (F::Log, &[-1.0], ErrorKind::Domain, "log of -1"), (F::Log, &[0.0], ErrorKind::Singular, "log of 0"),
        (F::Sqrt, &[-1e-20], ErrorKind::Domain, "sqrt of -0.00000000000000000001"), (F::ArcSin, &[2.0], ErrorKind::Domain, "arcsin of 2"),
        (F::ArcTan2, &[0.0, 0.0], ErrorKind::Singular, "arctan2(0, 0)"), (F::Div, &[1.0, 0.0], ErrorKind::Singular, "div(1, 0)"),
        (F::RPower, &[-2.0, 2.0], ErrorKind::Domain, "(-2) ** 2: the base of a real power must not be negative"),
        (F::Power, &[2.0, 2.5], ErrorKind::NotWhole, "power(2, 2.5): 2.5 is not a whole number"),
        (F::Gamma, &[-1.0], ErrorKind::Singular, "gamma of -1"), (F::LogGamma, &[-0.5], ErrorKind::Domain, "loggamma of -0.5"),
        (F::Centropy, &[0.0, 0.0], ErrorKind::Singular, "centropy(0, 0)"), (F::Entropy, &[-1.0], ErrorKind::Domain, "entropy of -1"),
        (F::Mod, &[5.0, 0.0], ErrorKind::Singular, "mod(5, 0)"), (F::NcpCm, &[1.0, 2.0, 0.0], ErrorKind::Domain, "ncpcm(1, 2, 0)"),
        (F::BetaReg, &[1.1, 2.0, 3.0], ErrorKind::Domain, "betareg(1.1, 2, 3)"), (F::Tan, &[1e20], ErrorKind::Precision, "tan of 100000000000000000000: no digit of the result would be right"),
        (F::Sin, &[f64::INFINITY], ErrorKind::Infinite, "sin of inf: the function does not take an infinite argument"),
        (F::Logit, &[1.0], ErrorKind::Singular, "logit of 1"), (F::Exp, &[], ErrorKind::Arguments, "exp(): wrong number of arguments"),
    ];
    for (f, args, kind, words) in cases {
        let e = function_value(*f, args).expect_err(words);
        assert_eq!((e.kind, e.to_string().as_str()), (*kind, *words));
    }
}

#[test]
fn derivatives_that_do_not_exist_are_errors_only_where_wanted() {
    let derivative = |f: Function, args: &[f64], active: &[bool]| {
        let n = args.len();
        let (mut g, mut h) = (vec![0.0; n], vec![0.0; n * (n + 1) / 2]);
        partials(f, args, active, &mut g, &mut h)
            .map(|_| (g, h))
            .map_err(|e| e.kind)
    };
    assert_eq!(
        derivative(F::Sqrt, &[0.0], &[true]),
        Err(ErrorKind::Derivative)
    );
    assert_eq!(
        derivative(F::Entropy, &[0.0], &[true]),
        Err(ErrorKind::Derivative)
    );
    assert_eq!(
        derivative(F::RPower, &[0.0, 0.5], &[true, false]),
        Err(ErrorKind::Derivative)
    );
    assert_eq!(
        derivative(F::RPower, &[0.0, 1.5], &[true, false]),
        Err(ErrorKind::Derivative)
    );
    assert_eq!(
        derivative(F::RPower, &[0.0, 1.0], &[true, true]),
        Err(ErrorKind::Derivative)
    );
    assert_eq!(
        derivative(F::RPower, &[0.0, 2.0], &[true, true]).unwrap().1,
        [2.0, 0.0, 0.0]
    );
    assert_eq!(
        derivative(F::EDist, &[0.0, 0.0], &[true, true]),
        Err(ErrorKind::Derivative)
    );
    assert_eq!(derivative(F::Abs, &[0.0], &[true]).unwrap().0, [0.0]);
    assert_eq!(
        derivative(F::Max, &[1.0, 1.0, 0.0], &[true; 3]).unwrap().0,
        [0.5, 0.5, 0.0]
    );
    let (g, h) = derivative(F::Power, &[-2.0, 3.0], &[true, false]).unwrap();
    assert_eq!((g[0], h[0]), (12.0, -12.0));
    assert_eq!(
        derivative(F::Power, &[-2.0, 3.0], &[true, true]),
        Err(ErrorKind::Derivative)
    );
}

/// No arguments, however wild, make a panic.
#[test]
fn nothing_panics() {
    let wild = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.5,
        1e-310,
        1e308,
        -1e308,
        1e-20,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        2.5,
        171.5,
        -170.5,
        1e6,
    ];
    for &f in Function::ALL {
        for &a in &wild {
            for &b in &wild {
                for &c in &wild[..7] {
                    for args in [&[a][..], &[a, b], &[a, b, c]] {
                        let n = args.len();
                        let v = function_value(f, args);
                        let (mut g, mut h) = (vec![0.0; n], vec![0.0; n * (n + 1) / 2]);
                        let p = partials(f, args, &vec![true; n], &mut g, &mut h);
                        if let (Ok(v), Ok(p)) = (v, p) {
                            assert!(v == p || v.is_nan(), "{}{args:?}", f.name());
                        }
                    }
                }
            }
        }
    }
}
