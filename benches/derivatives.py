"""The models of derivatives.rs in CasADi: time per nonzero of rows, Jacobian and Hessian of the Lagrangian."""
import time
import casadi as ca

def best(f):
    b, t0 = 1e9, time.perf_counter()
    while time.perf_counter() - t0 < 0.4:
        t = time.perf_counter(); f(); b = min(b, time.perf_counter() - t)
    return b

def chain(n):
    x = ca.SX.sym('x', n)
    f = sum(100 * (x[i+1] - x[i]**2)**2 + (1 - x[i])**2 for i in range(n - 1))
    return x, ca.vertcat(f), n, 0.5

def rocket(nodes):
    x = ca.SX.sym('x', 4 * nodes)
    X = [x[4*k:4*k+4] for k in range(nodes)]
    step = 1.0 / nodes
    f = [(p[3] - 310 * p[1]**2 * ca.exp(-500 * (p[0] - 1))) / p[2] - (1 / p[0])**2 for p in X]
    g = []
    for k in range(nodes - 1):
        a, b = X[k], X[k+1]
        g.append(b[0] - a[0] - 0.5 * step * (a[1] + b[1]))
        g.append(b[1] - a[1] - 0.5 * step * (f[k] + f[k+1]))
        g.append(b[2] - a[2] + step * (a[3] + b[3]))
    return x, ca.vertcat(*g), 8 * (nodes - 1), 1.01

def report(name, model):
    x, g, nonlinear, start = model
    t = time.perf_counter()
    lam = ca.SX.sym('lam', g.shape[0])
    J = ca.jacobian(g, x)
    H = ca.tril(ca.hessian(ca.dot(lam, g), x)[0])
    fg, fj, fh = ca.Function('g', [x], [g]), ca.Function('j', [x], [J]), ca.Function('h', [x, lam], [H])
    setup = time.perf_counter() - t
    x0, l0 = ca.DM.ones(x.shape[0]) * start, ca.DM.ones(g.shape[0])
    buffers = []
    def runner(f, args):
        buf, run = f.buffer()
        import numpy as np
        keep = [np.ascontiguousarray(np.array(a, dtype=float).ravel()) for a in args]
        for i, a in enumerate(keep): buf.set_arg(i, memoryview(a))
        out = np.zeros(f.nnz_out(0)); buf.set_res(0, memoryview(out)); buffers.append((buf, keep, out))
        return run
    tg, tj, th = best(runner(fg, [x0])), best(runner(fj, [x0])), best(runner(fh, [x0, l0]))
    print(f"{name:>8} {nonlinear:>9} {J.nnz():>9} {H.nnz():>9}   {setup*1e3:>9.1f} ms   {tg/nonlinear*1e9:>7.2f} {tj/nonlinear*1e9:>7.2f} {th/H.nnz()*1e9:>7.2f}", flush=True)

print("   model nonlinear  jacobian   hessian       set-up        rows     jac    hess  (ns per nonzero), CasADi", ca.__version__)
for n in [10_000, 100_000, 1_000_000]:
    report('chain', chain(n))
    report('rocket', rocket(n // 8))
