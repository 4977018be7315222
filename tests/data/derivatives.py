"""Writes derivatives.csv: value, gradient and Hessian of every function at chosen points.

Computed with mpmath at 60 digits from the definitions (not from the formulas under test), rounded to
20 digits. Columns: function, arguments separated by blanks (exact doubles), value, gradient, lower
triangle of the Hessian by rows. Run: python3 derivatives.py > derivatives.csv
"""
import random
from mpmath import *
mp.dps = 60
random.seed(7)

def poly(x, *a): return sum(c * x**k for k, c in enumerate(a))
def smooth(base, order, above):
    def f(x, s):
        if (x > s) != above: return base(x)
        d = x - s
        t = taylor_of[base](s)
        return t[0] + t[1]*d + (t[2]*d*d/2 if order == 2 else 0)
    return f
rec = lambda x: 1/x
taylor_of = {
    exp: lambda s: (exp(s),)*3,
    log10: lambda s: (log10(s), 1/(s*ln(10)), -1/(s*s*ln(10))),
    rec: lambda s: (1/s, -1/s**2, 2/s**3),
}
def ncpvu(theta):
    def f(r, s, mu=mpf(0)):
        if abs(r-s) >= mu: return min(r, s)
        return (r+s-mu*theta((r-s)/mu))/2
    return f
theta_sin = lambda t: 2/pi*sin(pi/2*t+3*pi/2)+1
theta_pow = lambda t: (-t**4+6*t**2+3)/8
lse = lambda *x: ln(sum(exp(a) for a in x))
F = {
 'exp': exp, 'log': ln, 'log2': lambda x: ln(x)/ln(2), 'log10': lambda x: ln(x)/ln(10), 'sqrt': sqrt, 'sqr': lambda x: x*x,
 'sin': sin, 'cos': cos, 'tan': tan, 'arcsin': asin, 'arccos': acos, 'arctan': atan, 'sinh': sinh, 'cosh': cosh, 'tanh': tanh,
 'errorf': lambda x: erfc(-x/sqrt(2))/2, 'gamma': gamma, 'loggamma': lambda x: ln(gamma(x)),
 'entropy': lambda x: -x*ln(x), 'sigmoid': lambda x: 1/(1+exp(-x)), 'logit': lambda x: ln(x/(1-x)),
 'rpower': lambda x, y: exp(y*ln(x)), 'signpower': lambda x, y: sign(x)*abs(x)**y, 'arctan2': lambda y, x: atan2(y, x),
 'beta': lambda a, b: gamma(a)*gamma(b)/gamma(a+b), 'logbeta': lambda a, b: loggamma(a)+loggamma(b)-loggamma(a+b),
 'binomial': lambda n, k: gamma(n+1)/gamma(k+1)/gamma(n-k+1),
 'betareg': lambda x, a, b: betainc(a, b, 0, x)*gamma(a+b)/gamma(a)/gamma(b),
 'gammareg': lambda x, a: gammainc(a, 0, x)/gamma(a),
 'centropy': lambda x, y, z=mpf('1e-20'): x*ln((x+z)/(y+z)),
 'poly': poly, 'edist': lambda *x: sqrt(sum(a*a for a in x)), 'div': lambda x, y: x/y, 'div0': lambda x, y: x/y,
 'slexp': smooth(exp, 1, True), 'sqexp': smooth(exp, 2, True), 'sllog10': smooth(log10, 1, False), 'sqlog10': smooth(log10, 2, False),
 'slrec': smooth(rec, 1, False), 'sqrec': smooth(rec, 2, False),
 'ncpcm': lambda r, s, m: r-m*ln(1+exp((r-s)/m)), 'ncpf': lambda r, s, m: sqrt(r*r+s*s+2*m)-r-s,
 'ncpvusin': ncpvu(theta_sin), 'ncpvupow': ncpvu(theta_pow),
 'lsemax': lse, 'lsemin': lambda *x: -lse(*[-a for a in x]),
 'lsemaxsc': lambda t, *x: lse(*[t*a for a in x])/t, 'lseminsc': lambda t, *x: -lse(*[-t*a for a in x])/t,
}
any_ = [0.3, -0.7, 1.7, -3.2, 1e-8, 12.5, -20.25]
pos = [0.3, 1.0, 1.7, 1e-8, 12.5, 3e5, 0.999, 1.001]
pts = {
 'exp': any_+[300.0], 'log': pos, 'log2': pos, 'log10': pos, 'sqrt': pos+[1e-20], 'sqr': any_, 'sin': any_+[1e6], 'cos': any_+[1.5707963], 'tan': any_+[1.57],
 'arcsin': [0.3, -0.7, 1e-8, 0.9999999, -0.999], 'arccos': [0.3, -0.7, 1e-8, 0.9999999, -0.999], 'arctan': any_+[1e5], 'sinh': any_, 'cosh': any_, 'tanh': any_,
 'errorf': [0.3, -0.7, 1.7, -3.2, 1e-8, 5.0, -8.5, -20.25, -33.3], 'gamma': [0.3, 1.0, 1.4616, 1.5, 2.0, 4.5, 12.5, 60.2, 150.3, -0.5, -1.5, -3.7, -0.001, 1e-8, 7.0],
 'loggamma': [0.3, 1.5, 1.3, 2.5, 4.5, 9.99, 10.01, 12.5, 1e5, 1e-8, 60.2], 'entropy': pos+[0.5], 'sigmoid': any_+[40.0, -600.0], 'logit': [0.3, 0.7, 1e-8, 0.999, 0.51, 0.24],
}
U = random.uniform
two = lambda a, b, n=6: [(U(*a), U(*b)) for _ in range(n)]
pts['rpower'] = two((0.1, 5), (-3, 3)) + [(2.5, 2.0), (1e-5, 1.5), (1.0, 3.3), (7.0, -2.0)]
pts['signpower'] = two((-4, -0.1), (0.2, 3)) + two((0.1, 4), (0.2, 3), 3)
pts['arctan2'] = two((-3, 3), (-3, 3), 8) + [(1.0, -1.0), (1e-6, -2.0)]
pts['beta'] = two((0.1, 6), (0.1, 6)) + [(0.5, 0.5), (12.0, 30.0), (0.2, 20.0), (90.0, 110.0)]
pts['logbeta'] = pts['beta'] + [(300.0, 500.0), (2.5, 1e4)]
pts['binomial'] = [(5.5, 2.2), (5.0, 2.0), (0.5, -0.3), (20.0, 7.5), (200.5, 33.25), (-0.5, -0.25)]
pts['betareg'] = [(0.3, 2.0, 3.0), (0.7, 2.0, 3.0), (0.5, 0.5, 0.5), (0.05, 4.2, 1.3), (0.95, 4.2, 1.3), (0.4, 20.0, 31.0), (0.9, 0.3, 7.0)]
pts['gammareg'] = [(0.5, 2.0), (3.0, 2.0), (2.9, 2.0), (0.1, 0.3), (5.0, 0.3), (20.0, 25.5), (30.0, 25.5), (1.0, 1.0)]
pts['centropy'] = [(0.5, 0.2), (0.3, 0.30000001), (2.0, 7.5), (0.5, 0.2, 0.01), (1e-6, 0.4, 0.1)]
pts['poly'] = [(2.0, 1.0, 2.0, 3.0), (-1.5, 0.3, -2.0, 0.7, 1.1), (0.7, 1.0, 0.0, 0.5, 2.0, -3.0)]
pts['edist'] = [(3.0, 4.0), (0.3, -0.7, 1.9), (1e-3, 5.0)]
pts['div'] = pts['div0'] = two((-3, 3), (0.2, 3), 3) + [(1.0, -2.5)]
pts['slexp'] = pts['sqexp'] = [(2.0, 1.0), (0.5, 1.0), (-3.0, 1.0), (160.0, 150.0)]
pts['sllog10'] = pts['sqlog10'] = [(0.001, 0.01), (-0.5, 0.25), (0.3, 0.25)]
pts['slrec'] = pts['sqrec'] = [(0.001, 0.01), (-0.5, 0.25), (0.3, 0.25)]
pts['ncpcm'] = [(2.0, 3.0, 1.0), (3.0, 2.5, 0.3), (0.1, -0.2, 2.0), (40.0, 1.0, 1.5)]
pts['ncpf'] = [(3.0, 4.0, 0.5), (3.0, 4.0, 0.0), (-1.0, 2.0, 0.1), (1e-4, 20.0, 1e-6)]
pts['ncpvusin'] = pts['ncpvupow'] = [(1.0, 1.2, 1.0), (1.0, 0.5, 2.0), (3.0, 4.0, 0.5), (0.2, 0.21, 0.1)]
pts['lsemax'] = pts['lsemin'] = [(1.0, 2.0, 3.0), (0.3, -0.7), (100.0, 101.5, 99.0)]
pts['lsemaxsc'] = pts['lseminsc'] = [(2.0, 1.0, 2.0, 3.0), (0.5, 0.3, -0.7)]

def shift(f, args, i, h):
    a = list(args); a[i] += h; return a
def deriv(f, args, orders):
    # central differences of high order at 60 digits: steps of 1e-12 leave 24 and more digits
    mp.dps = 130
    try:
        args = [mpf(a) for a in args]
        h = [mpf(10)**-22 * (abs(a) if a else 1) for a in args]
        def g(i, a):
            # eighth order first difference
            c = [(1, mpf(4)/5), (2, mpf(-1)/5), (3, mpf(4)/105), (4, mpf(-1)/280)]
            return sum(w*(f(*shift(f, a, i, k*h[i])) - f(*shift(f, a, i, -k*h[i]))) for k, w in c)/h[i]
        def gg(i, j, a):
            c = [(1, mpf(4)/5), (2, mpf(-1)/5), (3, mpf(4)/105), (4, mpf(-1)/280)]
            return sum(w*(g(i, shift(f, a, j, k*h[j])) - g(i, shift(f, a, j, -k*h[j]))) for k, w in c)/h[j]
        n = len(args)
        return [g(i, args) for i in range(n)], [gg(i, j, args) for i in range(n) for j in range(i+1)]
    finally: mp.dps = 60
for name in F:
    for p in pts[name]:
        p = p if isinstance(p, tuple) else (p,)
        a = [mpf(t) for t in p]
        v = F[name](*a)
        g, h = deriv(F[name], p, 2)
        scale = max(map(abs, [v] + g + h))
        def sh(x): return '0' if abs(x) < scale*mpf(10)**-40 else nstr(x.real if isinstance(x, mpc) else x, 20, min_fixed=0, max_fixed=0)
        print(','.join([name, ' '.join(repr(t) for t in p), sh(v), ' '.join(map(sh, g)), ' '.join(map(sh, h))]))
