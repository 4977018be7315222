"""Complementarity problems of the kinds that the literature solves with PATH, drawn at random: bmod and, if given, GAMS with PATH.

    python3 benches/mcp_kinds.py BMOD [--gams GAMS] [--seeds 8] [--only KIND,...] [--large] [--keep FOLDER]

Each kind is a text with data by formulas of the seed; residuals decide, not the solver's word. A line per problem that one of the two does not
solve, a summary per kind: problems, solved by bmod, solved by PATH, processor seconds of both. --large: 1000 to 4000 unknowns
(beyond the limit of the GAMS for everybody). The last kind has no solution but at infinity.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import tempfile

# %S%: the seed; %N%: a size. Numbers in 0 ... 1 that are the same in every program: frac(sin(...)).
HEAD = """$offlisting
scalar seed / %S% /;
option limrow = 0, limcol = 0, solprint = off, iterlim = 100000, reslim = 60;
"""

KINDS = {
    # (small, large) sizes and the text
    "capacity_game": ((6, 24), """
set f /f1*f%N%/, s /s1*s10/;
parameter c(f), inv(f), theta(f), a(s), w(s), b;
c(f) = 2 + mod(seed*7 + ord(f)*5, 11)/4; inv(f) = 1 + mod(seed*3 + ord(f)*7, 13)/5; theta(f) = mod(seed + ord(f), 3)/2;
a(s) = 10 + 2*ord(s) + mod(seed*ord(s), 7); w(s) = 1/card(s); b = 0.3 + 0.1*mod(seed,5);
positive variable q(f,s), k(f), mu(f,s); variable p(s), total(s);
equation first(f,s), cap(f,s), invest(f), price(s), sales(s);
first(f,s).. w(s)*(c(f) - p(s) + theta(f)*b*q(f,s)) + mu(f,s) =g= 0;
cap(f,s).. k(f) =g= q(f,s);
invest(f).. inv(f) =g= sum(s, mu(f,s));
price(s).. p(s) =e= a(s) - b*total(s);
sales(s).. total(s) =e= sum(f, q(f,s));
model m / first.q, cap.mu, invest.k, price.p, sales.total /;
"""),
    "capacity_game_nonlinear": ((6, 24), """
set f /f1*f%N%/, s /s1*s10/;
parameter c(f), inv(f), theta(f), a(s), w(s);
c(f) = 2 + mod(seed*7 + ord(f)*5, 11)/4; inv(f) = 1 + mod(seed*3 + ord(f)*7, 13)/5; theta(f) = mod(seed + ord(f), 3)/2;
a(s) = 100 + 20*ord(s) + mod(seed*ord(s), 7); w(s) = 1/card(s);
positive variable q(f,s), k(f), mu(f,s); variable p(s), slope(s);
q.l(f,s) = 1; k.l(f) = 1; p.l(s) = 5; slope.l(s) = -1; p.lo(s) = 0.01;
equation first(f,s), cap(f,s), invest(f), price(s), slopes(s);
first(f,s).. w(s)*(c(f) + 0.02*sqr(q(f,s)) - p(s) - theta(f)*slope(s)*q(f,s)) + mu(f,s) =g= 0;
cap(f,s).. k(f) =g= q(f,s);
invest(f).. inv(f)*(1 + 0.01*k(f)) =g= sum(s, mu(f,s));
price(s).. sum(f, q(f,s)) - a(s)*p(s)**(-1.2) =e= 0;
slopes(s).. slope(s)*1.2*sum(f, q(f,s)) =e= -p(s);
model m / first.q, cap.mu, invest.k, price.p, slopes.slope /;
"""),
    "electricity": ((6, 25), """
set n /n1*n%N%/, f /f1*f4/; alias (n, k);
set l(n,k); l(n,k) = yes$(ord(k) = ord(n)+1 or (ord(n) = 1 and ord(k) = card(n)) or (ord(k) = ord(n)+3 and mod(ord(n)+seed,3) = 0));
parameter c(f,n), g(f,n), a(n), b(n), t(n,k), x(n,k);
c(f,n) = 5 + mod(seed*ord(f) + 3*ord(n), 17); g(f,n) = 20*mod(ord(f)+ord(n)+seed,3); a(n) = 40 + mod(seed*ord(n), 23); b(n) = 0.5 + 0.1*mod(ord(n),4);
t(l) = 8 + mod(seed*5, 9); x(l(n,k)) = 1 + mod(ord(n)+ord(k),3)/2;
positive variable s(f,n), y(f,n), rho(f,n), up(n,k), down(n,k); variable lam(f), w(n), p(n), d(n), flow(n,k);
equation sale(f,n), gen(f,n), cap(f,n), bal(f), clear(n), phase(n), kirch(n,k), most(n,k), least(n,k), dem(n);
dem(n).. p(n) =e= a(n) - b(n)*sum(f, s(f,n));
sale(f,n).. lam(f) + w(n) - p(n) + b(n)*s(f,n) =g= 0;
gen(f,n).. c(f,n) + 0.01*y(f,n) - w(n) + rho(f,n) - lam(f) =g= 0;
cap(f,n).. g(f,n) =g= y(f,n);
bal(f).. sum(n, s(f,n)) =e= sum(n, y(f,n));
clear(n).. sum(f, y(f,n) - s(f,n)) =e= sum(l(n,k), flow(l)) - sum(l(k,n), flow(l));
kirch(l(n,k)).. x(l)*flow(l) =e= d(n) - d(k);
phase(n).. sum(l(n,k), (w(n)-w(k) + up(l) - down(l))/x(l)) - sum(l(k,n), (w(k)-w(n) + up(l) - down(l))/x(l)) =e= 0;
most(l).. t(l) =g= flow(l);
least(l).. t(l) =g= -flow(l);
d.fx('n1') = 0; w.l(n) = 10;
model m / dem.p, sale.s, gen.y, cap.rho, bal.lam, clear.w, kirch.flow, phase.d, most.up, least.down /;
"""),
    "stackelberg": ((10, 300), """
set f /f1*f%N%/; parameter c(f), k(f), dq; c(f) = 1 + mod(seed*ord(f),9)/3; k(f) = 4 + mod(seed+ord(f),5);
positive variable x, q(f), mu(f); variable p, dp; p.lo = 0.1; p.l = 5; q.l(f) = 1; x.l = 2; dp.l = -0.5;
equation lead, follow(f), cap(f), price, conj;
lead.. 1.5 + 0.05*x - p - dp*x =g= 0;
follow(f).. c(f) + 0.1*q(f) - p + 0.2*q(f)*p/5 + mu(f) =g= 0;
cap(f).. k(f) =g= q(f);
price.. x + sum(f, q(f)) =e= (60 + 5*card(f))*p**(-1.1);
conj.. dp*(1 + 1.1*(60 + 5*card(f))*p**(-2.1)/(1 + sum(f, q(f)/(1+q(f))))) =e= -1;
model m / lead.x, follow.q, cap.mu, price.p, conj.dp /;
"""),
    "ces_equilibrium": ((5, 60), """
set i /i1*i%N%/, h /h1*h3/, r /k, l/; alias (i, j), (r, g);
parameter e(h,r), alpha(h,i), tax(i), sig(i), beta(i,r), io(j,i), va(i), th;
e(h,r) = 10*(1 + mod(seed*ord(h)+3*ord(r),5)); alpha(h,i) = 1 + mod(seed+ord(h)*ord(i),4); alpha(h,i) = alpha(h,i)/sum(j, alpha(h,j));
tax(i) = 0.1*mod(seed+ord(i),4); sig(i) = 0.4 + 0.3*mod(ord(i)+seed,5); sig(i)$(sig(i) = 1) = 1.05;
beta(i,'k') = 0.2 + 0.1*mod(ord(i)+seed,6); beta(i,'l') = 1 - beta(i,'k'); io(j,i) = 0.3/card(i)*(1 + mod(ord(i)*ord(j)+seed,3))/2; va(i) = 1 - sum(j, io(j,i));
positive variable y(i), p(i), w(r), m_(h); variable rev;
equation profit(i), market(i), factor(r), income(h), revenue;
$macro cost(i) (sum(g, beta(i,g)*w(g)**(1-sig(i)))**(1/(1-sig(i))))
profit(i).. (1+tax(i))*(va(i)*cost(i) + sum(j, io(j,i)*p(j))) =g= p(i);
market(i).. y(i) =g= sum(j, io(i,j)*y(j)) + sum(h, alpha(h,i)*m_(h)/p(i));
factor(r).. sum(h, e(h,r)) =g= sum(i, y(i)*va(i)*beta(i,r)*(cost(i)/w(r))**sig(i));
income(h).. m_(h) =g= sum(r, w(r)*e(h,r)) + rev/card(h);
revenue.. rev =e= sum(i, tax(i)*y(i)*(va(i)*cost(i) + sum(j, io(j,i)*p(j))));
y.l(i) = 10; p.l(i) = 1; w.l(r) = 1; m_.l(h) = 30; rev.l = 5; p.lo(i) = 1e-5; w.lo(r) = 1e-5; w.fx('l') = 1;
model m / profit.y, market.p, factor.w, income.m_, revenue.rev /;
"""),
    "traffic": ((4, 10), """
set n /n1*n%N%/; alias (n, i, j, d); set a(i,j); set od(d) / n1, n3 /; parameter ff(i,j), cap(i,j), dem(i,d);
a(i,j) = yes$(ord(i) <> ord(j) and (abs(ord(i)-ord(j)) <= 1 or abs(ord(i)-ord(j)) = card(n)-1 or mod(ord(i)*ord(j)+seed,4) = 0));
ff(a(i,j)) = 1 + mod(seed*ord(i)+ord(j),5); cap(a(i,j)) = 6 + mod(seed+ord(i)+ord(j),4)*3; dem(i,od(d))$(ord(i) <> ord(d)) = 1 + mod(seed*ord(i)+ord(d),3);
positive variable x(i,j,d), t(i,d), mu(i,j); equation route(i,j,d), flow(i,d), limit(i,j);
route(a(i,j),od(d)).. ff(a)*(1 + 0.15*power(sum(od.local, x(a,od))/cap(a),4)) + mu(a) + t(j,d) =g= t(i,d);
flow(i,od(d))$(ord(i) <> ord(d)).. sum(a(i,j), x(i,j,d)) - sum(a(j,i), x(j,i,d)) =g= dem(i,d) ;
limit(a).. 2*cap(a) =g= sum(od(d), x(a,d));
t.fx(d,d) = 0;
model m / route.x, flow.t, limit.mu /;
"""),
    "obstacle": ((16, 55), """
set i /0*%N%/, j /0*%N%/; scalar h; h = 1/%N%; set in(i,j); in(i,j) = yes$(ord(i) > 1 and ord(i) < card(i) and ord(j) > 1 and ord(j) < card(j));
parameter o(i,j), force; o(i,j) = power(sin((9+mod(seed,3))*(ord(i)-1)*h)*sin(9*(ord(j)-1)*h),3); force = -mod(seed,4);
positive variable v(i,j); variable u(i,j), dummy; equation bend(i,j);
u.lo(i,j) = o(i,j); u.up(i,j)$(mod(seed,2) = 1) = o(i,j) + 0.8; u.l(i,j) = o(i,j); u.fx(i,j)$(not in(i,j)) = 0;
u.fx(i,j)$(not in(i,j)) = max(0, o(i,j));
bend(in(i,j)).. 4*u(i,j) - u(i-1,j) - u(i+1,j) - u(i,j-1) - u(i,j+1) + (0.2*mod(seed,3))*sqr(h)*exp(u(i,j)) - force*sqr(h) =n= 0;
model m / bend.u /;
"""),
    "invariant_capital": ((5, 60), """
set j /j1*j%N%/, i /i1*i4/, r /r1*r3/; parameter aa(i,j), b(i,j), c(r,j), w(r), beta / 0.7 /;
aa(i,j) = mod(seed*ord(i)+ord(j)*3,5)/4; b(i,j) = 1.6*mod(seed+ord(i)*2+ord(j),4)/3; c(r,j) = (1 + mod(ord(r)*ord(j)+seed,4))/3; w(r) = 1 + ord(r)/5;
positive variable x(j), y(i), u(r); equation act(j), cap(i), res(r); x.l(j) = 0.2;
act(j).. -1/(1 + sum(r, c(r,j)*x(j))) *(1 + mod(ord(j),3)) + sum(i, (aa(i,j) - beta*b(i,j))*y(i)) + sum(r, c(r,j)*u(r)) =g= 0;
cap(i).. sum(j, (b(i,j) - aa(i,j))*x(j)) =g= 0;
res(r).. w(r) =g= sum(j, c(r,j)*x(j));
model m / act.x, cap.y, res.u /;
"""),
    "shared_constraints": ((6, 300), """
set f /f1*f%N%/, k /k1*k3/; parameter c1(f), c2(f), e(f), u(f,k), lim(k);
c1(f) = 0.1 + 0.02*mod(seed*ord(f),4); c2(f) = 0.01*(1 + mod(ord(f)+seed,5)); e(f) = 0.25 + 0.25*mod(ord(f),3); u(f,k) = 1 + mod(seed+ord(f)*ord(k),7); lim(k) = 40*card(f)/3;
positive variable x(f), mu(k); variable q; equation first(f), share(k), total; x.l(f) = 1;
first(f).. c1(f) + 2*c2(f)*x(f) - 3 + 0.01*(q + x(f)) + e(f)*sum(k, u(f,k)*mu(k)*(1 + 0.1*mod(ord(f),2))) + 0.001*power(x(f),3) =g= 0;
total.. q =e= sum(f, x(f));
share(k).. lim(k) =g= sum(f, e(f)*u(f,k)*x(f)) + 0.1*sqrt(1 + q);
model m / first.x, share.mu, total.q /;
"""),
    "kkt_of_nlp": ((40, 900), """
set t /0*%N%/; scalar h; h = 1/%N%*4; variable x(t), u(t), lam(t); positive variable nu(t); equation state(t), dx(t), du(t), path(t);
x.fx('0') = 1 + mod(seed,4)/4; u.lo(t) = -1.5; u.up(t) = 1.5; x.l(t) = 1;
state(t)$(ord(t) > 1).. x(t) =e= x(t-1) + h*(x(t-1) - 0.3*power(x(t-1),3) + u(t-1)*(1 + 0.2*mod(seed,3)*x(t-1)));
dx(t)$(ord(t) > 1).. h*2*(x(t) - 0.2) + lam(t) - (lam(t+1)*(1 + h*(1 - 0.9*sqr(x(t)) + u(t)*0.2*mod(seed,3))))$(ord(t) < card(t)) - nu(t) =e= 0;
du(t)$(ord(t) < card(t)).. h*0.2*u(t) - lam(t+1)*h*(1 + 0.2*mod(seed,3)*x(t)) =n= 0;
path(t)$(ord(t) > 1).. x(t) =g= -0.1 + 0.05*mod(seed,2);
u.fx(t)$(ord(t) = card(t)) = 0;
model m / state.lam, dx.x, du.u, path.nu /;
"""),
    "asymptotic": ((3, 3), """
set i /i1*i%N%/; positive variable x(i), y; equation e(i), t; x.l(i) = mod(seed,3);
e(i).. y/10 - 1/(1 + x(i)*(1 + mod(seed,4)/4)) =g= 0;
t.. y =g= 0;
model m / e.x, t.y /;
"""),
}


def measured(command, folder):
    with open(os.path.join(folder, "out"), "w+") as out:
        p = subprocess.Popen(command, stdout=out, stderr=subprocess.DEVNULL, cwd=folder)
        _, _, usage = os.wait4(p.pid, 0)
        p.returncode = 0
        out.seek(0)
        return usage.ru_utime + usage.ru_stime, out.read()


def by_bmod(program, file, folder):
    seconds, text = measured([program, "run", file, "--json", "-", "--out", folder, "--time-limit", "60"], folder)
    try:
        s = json.loads(text)["solves"][-1]
        return seconds, s["model_status"]["name"], s.get("message") or ""
    except (ValueError, LookupError):
        return seconds, "none", text[:300]


def by_path(program, file, folder):
    seconds, _ = measured([program, file, "lo=0", "o=list", "threads=1"], folder)
    text = (pathlib.Path(folder) / "list").read_text(errors="replace")
    found = re.search(r"MODEL STATUS +(\d+) +(.*)", text)
    return seconds, found.group(2).strip() if found else "none", "\n".join(re.findall(r"^\*\*\*\*.*", text, re.M)[:4])


def main():
    options = argparse.ArgumentParser()
    options.add_argument("bmod")
    options.add_argument("--gams")
    options.add_argument("--seeds", type=int, default=8)
    options.add_argument("--only")
    options.add_argument("--large", action="store_true")
    options.add_argument("--keep")
    a = options.parse_args()
    total = [0, 0, 0, 0.0, 0.0]
    for kind, (sizes, text) in KINDS.items():
        if a.only and kind not in a.only.split(","):
            continue
        sums = [0, 0, 0, 0.0, 0.0]
        for seed in range(1, a.seeds + 1):
            with tempfile.TemporaryDirectory() as folder:
                file = os.path.join(a.keep or folder, f"{kind}_{seed}.gms")
                model = HEAD + text + "solve m using mcp;\n"
                pathlib.Path(file).write_text(model.replace("%S%", str(seed)).replace("%N%", str(sizes[a.large])))
                mine = by_bmod(os.path.abspath(a.bmod), file, folder)
                theirs = by_path(a.gams, file, folder) if a.gams else (0.0, "", "")
            good = lambda status: status.lower() in ("optimal", "locally optimal", "solved")
            if not good(mine[1]) or a.gams and not good(theirs[1]):
                print(f"{kind} {seed}: {mine[1]} ({mine[2]}), PATH {theirs[1]} {theirs[2] if theirs[1] == 'none' else ''}", flush=True)
            for k, v in enumerate((1, good(mine[1]), good(theirs[1]), mine[0], theirs[0])):
                sums[k] += v
                total[k] += v
        print(f"{kind:24} {sums[0]:3} bmod {sums[1]:3} in {sums[3]:6.2f} s, PATH {sums[2]:3} in {sums[4]:6.2f} s", flush=True)
    print(f"{'all':24} {total[0]:3} bmod {total[1]:3} in {total[3]:6.2f} s, PATH {total[2]:3} in {total[4]:6.2f} s")


if __name__ == "__main__":
    main()
