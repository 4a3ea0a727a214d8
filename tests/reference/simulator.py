#!/usr/bin/env python3
"""Simulates the model of coincident events (README.md) in 400-bit arithmetic, testing all pairs on both axes.

    simulator.py SCENE.toml [--log] [--decay] > states.csv

Prints step,name,x,y,vx,vy to 17 digits, and on standard error the number of collisions (with --log also each of them).
Numbers of the scene are taken as the decimals they are. --decay carries bursts out until they have decayed, without looking
for a repetition. Overlapping spawns, clicks and scatter are not supported.
It checks itself: no overlap, no pulling, energy never rises. It shares no code with rebond.
"""
import sys, tomllib, math
import gmpy2
from gmpy2 import mpfr
gmpy2.get_context().precision = 400
P = lambda n: mpfr(2) ** n
ZERO = mpfr(0)

CYCLES = '--decay' not in sys.argv            # --decay: bursts are carried out until they have decayed, no short cut
FINE = 120, 150, 112, 100                     # bits up to which lengths, speeds and accelerations, heights of bounces are not nothing,
COARSE = 64, 92, 64, 80                       # and to which a burst decays; the second are those of rebond
class Crushed(Exception): pass
class Endless(Exception): pass

class Sim:
    bits = FINE
    def __init__(s, g, rest, limit=300000):
        s.g, s.rest, s.limit = g, rest, limit
        s.name, s.x, s.v, s.a, s.z, s.m, s.f, s.mat, s.alive = [], [], [], [], [], [], [], [], []
        s.blocks = set()                                # contacts that corners have begun from rest in this instant
        s.contacts, s.log, s.now, s.L, s.V, s.A = set(), [], ZERO, ZERO, ZERO, ZERO   # contacts: (i, j, axis), i < j
    def spawn(s, name, at, size, mass, vel=(0, 0), force=(0, 0), mat=None):
        inf = gmpy2.is_infinite(mass)
        s.name.append(name); s.x.append(list(map(mpfr, at))); s.z.append(list(map(mpfr, size))); s.v.append(list(map(mpfr, vel)))
        s.m.append(None if inf else mpfr(mass)); s.mat.append(mat); s.alive.append(True)
        s.f.append([ZERO, ZERO] if inf else [mpfr(s.g[k]) + mpfr(force[k]) / mass for k in (0, 1)]); s.a.append(list(s.f[-1])); s.scales()
    def delete(s, name):
        i = max(i for i in range(len(s.name)) if s.name[i] == name and s.alive[i])
        s.alive[i] = False; s.contacts = {c for c in s.contacts if i not in c[:2]}
    def scales(s):                                  # what counts as nothing: lengths, speeds, accelerations
        al = [i for i in range(len(s.name)) if s.alive[i]]
        s.L = max([s.L] + [s.z[i][k] for i in al for k in (0, 1)] + [abs(s.x[i][k]) for i in al for k in (0, 1) if s.m[i]])
        s.A = max([s.A] + [abs(s.f[i][k]) for i in al for k in (0, 1)])
        s.V = max([abs(s.v[i][k]) for i in al for k in (0, 1)] + [gmpy2.sqrt(s.A * s.L)])
        length, speed, height, _ = s.bits
        s.EG, s.EC, s.EA, s.HB = P(-length) * s.L, P(-speed) * s.V, P(-speed) * s.A, P(-height) * s.L
    def e(s, i, j):
        a, b = s.mat[i], s.mat[j]
        return s.rest.get(f'{a}/{b}', s.rest.get(f'{b}/{a}', s.rest['default'])) if a and b else s.rest['default']
    def gap(s, i, j, k):                            # gap along k, and whether j is ahead of i
        d = s.x[j][k] - s.x[i][k]; p, q = d - s.z[i][k], -d - s.z[j][k]
        g, ahead = (p, True) if p > q else (q, False)
        return (ZERO if abs(g) <= s.EG else g), ahead
    def rate(s, q, i, j, k): return q[i][k] - q[j][k] if s.gap(i, j, k)[1] else q[j][k] - q[i][k]
    def c(s, i, j, k):                              # approach speed; 0 if below rounding
        c = s.rate(s.v, i, j, k); return ZERO if abs(c) <= s.EC else c
    def al(s, i, j, k): a = s.rate(s.a, i, j, k); return ZERO if abs(a) <= s.EA else a
    def pairs(s):
        n = [i for i in range(len(s.name)) if s.alive[i]]
        return [(i, j) for i in n for j in n if i < j and (s.m[i] or s.m[j])]
    def touching(s):                                # [(i, j, 0 | 1 face along the axis | 2 corner)]
        out = []
        for i, j in s.pairs():
            gx, gy = s.gap(i, j, 0)[0], s.gap(i, j, 1)[0]
            assert not (gx < 0 and gy < 0), f'overlap {s.name[i]} {s.name[j]} {float(gx):.3g} {float(gy):.3g} t={float(s.now)}'
            if gx == 0 and gy < 0: out.append((i, j, 0))
            elif gy == 0 and gx < 0: out.append((i, j, 1))
            elif gx == 0 and gy == 0: out.append((i, j, 2))
        return out
    # ---- resting: contacts and accelerations from positions, velocities and the contacts before
    def settle(s, touch):
        keep, turning = set(), set()
        corners = [(i, j) for i, j, k in touch if k == 2]
        both = {(i, j, k) for i, j in corners for k in (0, 1) if {(i, j, 0), (i, j, 1)} <= s.contacts}
        s.contacts -= s.blocks | both               # which corners are entered is decided anew
        s.blocks = set()
        for i, j, k in s.contacts:
            o = 1 - k; go, co = s.gap(i, j, o)[0], s.c(i, j, o)
            if s.gap(i, j, k)[0] != 0 or s.c(i, j, k) != 0 or go > 0 or (go == 0 and co < 0): continue
            keep.add((i, j, k))
            if go == 0 and co == 0: turning.add((i, j, k))
        T = {(i, j, k) for i, j, k in touch if k < 2 and s.c(i, j, k) == 0} | keep
        released = set()
        while True:
            s.solve(T)
            gone = {t for t in turning if s.al(t[0], t[1], 1 - t[2]) <= 0}
            if gone: T -= gone; turning -= gone; continue
            new = set()
            for i, j in corners:
                if (i, j, 0) in T or (i, j, 1) in T: continue
                for k in s.blocked([(s.c(i, j, q), s.al(i, j, q)) for q in (0, 1)]):
                    if s.c(i, j, k) == 0: new.add((i, j, k))
            T |= new; s.blocks |= new
            if new: continue
            left = {(i, j) for i, j, k in s.blocks if (i, j) not in released and s.left(i, j)}
            if not left: break
            released |= left; gone = {b for b in s.blocks if b[:2] in left}
            T -= gone; s.blocks -= gone
        tight = [t for t in T if s.al(*t) == 0]
        s.contacts = set()
        for k in (0, 1):
            comps = s.comps([(i, j) for i, j, q in tight if q == k])
            carried = {i for comp in comps for i in comp if any(s.m[b] and abs(s.a[b][k] - s.f[b][k]) > s.EA for b in comp)}
            s.contacts |= {t for t in tight if t[2] == k and (t in keep or (t[0] if s.m[t[0]] else t[1]) in carried)}
            for comp in s.comps([t[:2] for t in s.contacts if t[2] == k]): s.unify(comp, [t for t in s.contacts if t[2] == k], k)
    def left(s, i, j):                              # a blocked corner that is not entered any more, because others block too
        for k in (0, 1):
            c, a = s.c(i, j, k), s.al(i, j, k)
            if c == 0 and (a != 0 if (i, j, k) in s.blocks else a <= 0): return True
        return False
    @staticmethod
    def blocked(ca):                                # which axes a corner blocks: the gentler one; both if equal; none if it is not entered
        if not all(c > 0 or (c == 0 and a > 0) for c, a in ca): return ()
        (cx, ax), (cy, ay) = ca
        if cx == 0 and cy == 0: d = ax - ay; tiny = P(-150) * (ax + ay)
        else: d = cx - cy; tiny = P(-140) * (cx + cy)
        return (0, 1) if abs(d) <= tiny else ((0,) if d < 0 else (1,))
    def comps(s, edges):                            # connected by these pairs; infinite masses do not connect
        adj, out, seen = {}, [], set()
        for i, j in edges:
            adj.setdefault(i, []).append(j); adj.setdefault(j, []).append(i)
        for i in sorted(adj):
            if i in seen or not s.m[i]: continue
            comp, todo = [], [i]; seen.add(i)
            while todo:
                b = todo.pop(); comp.append(b)
                for d in adj[b]:
                    if s.m[d] and d not in seen: seen.add(d); todo.append(d)
            out.append(sorted(comp))
        return out
    def unify(s, comp, edges, k):                   # one velocity: the infinite mass's, else that of the common momentum
        inf = [(i if not s.m[i] else j) for i, j, *_ in edges if (i in comp or j in comp) and not (s.m[i] and s.m[j])]
        v = s.v[inf[0]][k] if inf else sum(s.m[b] * s.v[b][k] for b in comp) / sum(s.m[b] for b in comp)
        for b in comp: s.v[b][k] = v
    def solve(s, T):                                # accelerations of least change, per axis and component
        for i in range(len(s.name)): s.a[i] = list(s.f[i])
        for k in (0, 1):
            E = [((i, j) if s.gap(i, j, k)[1] else (j, i)) for i, j, q in T if q == k]
            for comp in s.comps(E):
                C = set(comp); order = [(i, j) for i, j in E if i in C and j in C]
                zb = {j for i, j in E if j in C and not s.m[i]}; za = {i for i, j in E if i in C and not s.m[j]}
                a = least_change(comp, {b: s.f[b][k] for b in comp}, s.m, order, zb, za, s.EA)
                for b in comp: s.a[b][k] = a[b]
                inner = sum(s.m[b] * (a[b] - s.f[b][k]) * a[b] for b in comp)
                assert all(a[i] <= a[j] + s.EA for i, j in order) and all(a[b] >= -s.EA for b in zb) and all(a[b] <= s.EA for b in za)
                assert abs(inner) <= P(-140) * sum(s.m[b] for b in comp) * s.A * s.A, 'contact forces do no work'
    # ---- impacts of one instant
    def block(s, b, k, ahead):                      # what a blow on b pushes: bodies, mass (None = infinite)
        mem, todo = [b], [b]
        if not s.m[b]: return [b], None
        while todo:
            p = todo.pop()
            for i, j, q in s.contacts:
                if q != k or p not in (i, j): continue
                d = j if p == i else i
                if s.gap(p, d, k)[1] != ahead or d in mem: continue
                if not s.m[d]: return [b], None
                mem.append(d); todo.append(d)
        return mem, sum(s.m[p] for p in sorted(mem))
    def burst(s, touch):
        touch = sorted(touch, key=lambda t: t[2] == 2)   # faces before corners
        root = {}
        for n, comp in enumerate(s.comps([t[:2] for t in touch])): root.update({b: n for b in comp})
        top, count, past = {}, 0, {}
        s.squeezed(touch)
        while True:
            for i, j, k in touch:
                if k < 2: ax = (k,) if s.c(i, j, k) > 0 else ()
                else:
                    cc = [s.c(i, j, q) for q in (0, 1)]
                    ax = s.blocked([(c, ZERO) for c in cc]) if min(cc) > 0 else ()
                if ax: break
            else: return
            n = root[i if s.m[i] else j]
            for k in ax: s.impact(i, j, k, touch, top, n)
            count += 1
            if len(ax) == 1 and CYCLES: s.cycle(past.setdefault((n, ax[0]), []), i, j, ax[0], touch, top[n])
            if count > s.limit: raise Endless(f'{s.name[i]} {s.name[j]} at {float(s.now)}')
    def squeezed(s, touch):                         # a chain of touching faces between infinite masses that approach
        for k in (0, 1):
            E = [t[:2] for t in touch if t[2] == k]
            for comp in s.comps(E):
                lim = {True: [], False: []}
                for i, j in E:
                    b, a = (i, j) if s.gap(i, j, k)[1] else (j, i)
                    if not s.m[b] and a in comp: lim[False].append((b, a))
                    if not s.m[a] and b in comp: lim[True].append((a, b))
                for p, b in lim[False]:
                    reach, todo = {b}, [b]
                    while todo:
                        q = todo.pop()
                        for i, j in E:
                            lo, hi = (i, j) if s.gap(i, j, k)[1] else (j, i)
                            if lo == q and s.m[hi] and hi not in reach: reach.add(hi); todo.append(hi)
                    for w, d in lim[True]:
                        if d in reach and s.v[p][k] - s.v[w][k] > s.EC: raise Crushed(f'{s.name[b]} between {s.name[p]} and {s.name[w]} at {float(s.now)}')
    def cycle(s, past, i, j, k, touch, top):           # the limit of a cycle of impacts that repeats itself for ever, found early
        past.append((i, j, [list(v) for v in s.v]))
        if len(past) % 16 or len(past) < 48: return
        for per in range(2, min(200, len(past) // 3)):
            keys = [q[:2] for q in past[-3 * per:]]
            if keys[-per:] != keys[:per] or keys[-per:] != keys[per:2 * per]: continue
            pairs = sorted(set(keys[-per:])); hit = {b for q in pairs for b in q}
            links = pairs + [q[:2] for q in s.contacts if q[2] == k]     # contacts last as long as the cycle
            comp = [q for q in s.comps(links) if hit & set(q)]
            if len(comp) != 1: return
            rel = [[past[-1 - q * per][2][a][k] - past[-1 - q * per][2][b][k] for a, b in pairs] for q in (0, 1, 2)]
            n0, n1, n2 = (gmpy2.sqrt(sum(x * x for x in r)) for r in rel)
            if not P(-32) * top < n0 < n1 < n2 or any(abs(x / n0 - y / n1) > P(-60) for x, y in zip(rel[0], rel[1])): return
            old = [list(v) for v in s.v]
            held = [b for b in comp[0] for ahead in (False, True) if s.block(b, k, ahead)[1] is None]
            if held: # a body that rests on an infinite mass answers like it
                for b in comp[0]: s.v[b][k] = s.v[held[0]][k]
            else: s.unify(comp[0], [q for q in links if set(q) & set(comp[0])], k)
            out = [t for t in touch if t[2] == k and t[:2] not in links and (t[0] in comp[0]) + (t[1] in comp[0])]
            if any(s.c(*t) > 0 for t in out): s.v = old; return    # an outsider is reached on the way: go on
            s.contacts |= {(a, b, k) for a, b in pairs}; past.clear(); return
    def impact(s, i, j, k, touch, top, n):
        b, a = (i, j) if s.gap(i, j, k)[1] else (j, i); c, e = s.c(i, j, k), s.e(i, j)
        top[n] = max(top.get(n, ZERO), c)
        if c <= P(-s.bits[3]) * top[n]:                   # decayed: the limit of an infinite sequence
            slow = [t for t in touch if t[2] == k and abs(s.c(*t)) <= P(-s.bits[3]) * top[n]]
            comp = next(q for q in s.comps([t[:2] for t in slow] + [(i, j)]) if i in q or j in q)
            mine = [t for t in slow if t[0] in comp or t[1] in comp]
            if any(s.e(p, q) < 1 for p, q, _ in mine):
                s.unify(comp, mine, k); s.contacts |= {(p, q, k) for p, q, _ in mine}
                s.log.append((s.now, i, j, k, -c, ZERO, ZERO)); return
        (Bm, mb), (Am, ma) = s.block(b, k, False), s.block(a, k, True)
        if mb is None and ma is None: raise Crushed(f'{s.name[i]} {s.name[j]} at {float(s.now)}')
        J = (1 + e) * c / ((1 / mb if mb else 0) + (1 / ma if ma else 0)); assert J > 0
        for p in Bm:
            if mb: s.v[p][k] -= J / mb
        for p in Am:
            if ma: s.v[p][k] += J / ma
        if e == 0:
            s.v[a][k] = s.v[b][k] if ma else s.v[a][k]
            if not ma: s.v[b][k] = s.v[a][k]
            s.contacts.add((i, j, k))
        s.contacts = {t for t in s.contacts if t[2] != k or s.c(*t) == 0}
        s.log.append((s.now, i, j, k, -c, e * c, J))
    def energy(s): return sum(s.m[i] * (s.v[i][0] ** 2 + s.v[i][1] ** 2) / 2 for i in range(len(s.m)) if s.alive[i] and s.m[i])
    def instant(s):
        s.scales(); touch = s.touching(); s.blocks = set()
        s.settle(touch); before = s.energy(); s.burst(touch)
        still = all(s.m[i] or s.v[i] == [0, 0] for i in range(len(s.m)) if s.alive[i])
        assert not still or s.energy() <= before * (1 + P(-90)), 'energy rises'
        s.settle(touch)
        while True:                                 # bounces that would not rise above the resolution of coordinates
            for i, j, k in touch:
                if k == 2 or s.e(i, j) == 1: continue
                c, al = s.c(i, j, k), s.al(i, j, k)
                if c < 0 < al and c * c <= 2 * al * s.HB: s.capture(i, j, k); break
            else: break
            s.burst(touch); s.settle(touch)
        assert all(s.c(*t) <= 0 for t in touch if t[2] < 2), 'still approaching'
    def capture(s, i, j, k):
        b, a = (i, j) if s.gap(i, j, k)[1] else (j, i)
        (Bm, mb), (Am, ma) = s.block(b, k, False), s.block(a, k, True)
        if mb is None and ma is None: raise Crushed('capture')
        v = s.v[b][k] if mb is None else s.v[a][k] if ma is None else (mb * s.v[b][k] + ma * s.v[a][k]) / (mb + ma)
        for p in (Bm if mb else []) + (Am if ma else []): s.v[p][k] = v
        s.contacts.add((i, j, k))
    # ---- time
    def next(s, horizon):
        best = horizon
        for i, j in s.pairs():
            for k in (0, 1):
                if (i, j, k) in s.contacts: continue
                d, dv, da = s.x[j][k] - s.x[i][k], s.v[j][k] - s.v[i][k], s.a[j][k] - s.a[i][k]
                if abs(dv) <= s.EC: dv = ZERO
                if abs(da) <= s.EA: da = ZERO
                if dv == 0 and da == 0: continue
                for G, v, w in ((d - s.z[i][k], dv, da), (-d - s.z[j][k], -dv, -da)):
                    if abs(G) <= s.EG: G = ZERO
                    for t in roots(G, v, w):
                        if not s.ET < t < best: continue
                        o = 1 - k; q = s.x[j][o] - s.x[i][o] + t * (s.v[j][o] - s.v[i][o]) + t * t / 2 * (s.a[j][o] - s.a[i][o])
                        if max(q - s.z[i][o], -q - s.z[j][o]) <= 2 * s.EG: best = t
        return best
    def advance(s, t):
        for i in range(len(s.name)):
            for k in (0, 1):
                s.x[i][k] += t * (s.v[i][k] + t / 2 * s.a[i][k]); s.v[i][k] += t * s.a[i][k]
        s.now += t
    def run_to(s, T):
        while s.now < T:
            t = s.next(T - s.now + s.ET)
            if s.now + t > T - s.ET:
                hit = t < T - s.now + s.ET; s.advance(T - s.now); s.now = T
                if hit or any(k < 2 and s.c(i, j, k) > 0 for i, j, k in s.touching()): s.instant()
                return
            s.advance(t); s.instant()
            if len(s.log) > s.limit: raise Endless(f'more than {s.limit} collisions')

def roots(g, v, w):                                 # t with g + v t + w t²/2 = 0
    if w == 0: return [-g / v] if v else []
    if g == 0: return [-2 * v / w]
    D = v * v - 2 * w * g
    if D < 0: return []
    r = gmpy2.sqrt(D); q = -(v + r) if v > 0 else r - v
    return [q / w] + ([2 * g / q] if q else [])

def least_change(comp, f, m, order, zb, za, tiny):
    """min Σ m (a − f)², a_i ≤ a_j for (i, j) in order, 0 ≤ a of zb, a of za ≤ 0: greatest lower set of least average, repeatedly."""
    if not order and len(comp) == 1:
        b, = comp; a = f[b]; return {b: max(a, ZERO) if b in zb and b not in za else min(a, ZERO) if b in za and b not in zb else ZERO if b in za else a}
    if len({f[b] for b in comp}) == 1:              # the same free fall: held or falling
        f0 = f[comp[0]]; held, todo = set(), list(za if f0 > 0 else zb if f0 < 0 else [])
        while todo:
            b = todo.pop()
            if b not in held: held.add(b); todo += [(i if f0 > 0 else j) for i, j in order if (j if f0 > 0 else i) == b]
        return {b: ZERO if b in held else f0 for b in comp}
    n = len(comp); ix = {b: q for q, b in enumerate(comp)}; B, Aa = 1 << n, 2 << n
    need = [0] * (n + 2)                            # what must be in a lower set with this one
    for i, j in order: need[ix[j]] |= 1 << ix[i]
    for b in zb: need[ix[b]] |= B
    for b in za: need[n + 1] |= 1 << ix[b]
    left = (1 << n) - 1 | (B if zb else 0) | (Aa if za else 0); a = {}
    assert n <= 14, 'component too large for the reference'
    closed = [q for q in range(1, 1 << (n + 2)) if q & left == q and all(need[t] & q == need[t] for t in range(n + 2) if q >> t & 1)]
    sums = {}
    for q in closed:
        bs = [comp[t] for t in range(n) if q >> t & 1]; sums[q] = (sum((m[b] * f[b] for b in bs), ZERO), sum((m[b] for b in bs), ZERO))
    done, tm = 0, P(-160)
    while done != left:
        best = None
        df, dm = sums.get(done, (ZERO, ZERO))
        for q in closed:
            if q & done != done or q == done: continue
            F, M = sums[q][0] - df, sums[q][1] - dm; z = bin((q & ~done) >> n).count('1')
            key = (F / M, ZERO) if not z else (ZERO, F / z)
            if best is None: best = (key, q); continue
            (p0, p1), bq = best; d0, d1 = key[0] - p0, key[1] - p1
            less = d0 < -tiny or (abs(d0) <= tiny and d1 < -tm * sum(abs(m[b]) for b in comp) * (tiny / P(-150) + 1))
            same = abs(d0) <= tiny and not less and not d1 > tm * sum(abs(m[b]) for b in comp) * (tiny / P(-150) + 1)
            if less or (same and q & bq == bq and q != bq): best = (key, q)
        (avg, _), q = best
        for t in range(n):
            if q >> t & 1 and not done >> t & 1: a[comp[t]] = avg
        done = q
    return a

def load(text):
    d = tomllib.loads(text, parse_float=mpfr)
    w, run = d.get('world', {}), d['run']; rest = {k: mpfr(v) for k, v in d.get('restitution', {}).items()}; rest.setdefault('default', mpfr(1))
    s = Sim(w.get('gravity', [0, 0]), rest); rate = mpfr(run.get('rate', 60)); steps = run.get('steps') or int(gmpy2.ceil(mpfr(run['duration']) * rate))
    s.ET = P(-140) * steps / rate; ev = []
    if w.get('walls'):
        W, H = w.get('size', [16, 9]); I = mpfr('inf'); mat = w.get('wall_material')
        for n, at, z in (('top', (-1, -1), (W + 2, 1)), ('bottom', (-1, H), (W + 2, 1)), ('left', (-1, 0), (1, H)), ('right', (W, 0), (1, H))): s.spawn('wall-' + n, at, z, I, mat=mat)
    for n, b in enumerate(d.get('spawn', [])): ev.append((b.get('step', 0), 1, n, b))
    for n, b in enumerate(d.get('delete', [])): ev.append((b['step'], 0, n, b))
    return s, rate, steps, sorted(ev, key=lambda q: q[:3])

def simulate(text, sample=None):
    s, rate, steps, ev = load(text); n = 0
    for k in range(steps + 1):
        if k: s.run_to(k / rate)
        happened = k == 0
        while ev and ev[0][0] == k:
            _, what, idx, b = ev.pop(0); happened = True
            if what: s.spawn(b.get('name', f'#{idx + 1}'), b['at'], b['size'], mpfr(b['mass']), b.get('velocity', (0, 0)), b.get('force', (0, 0)), b.get('material'))
            else: s.delete(b['name'])
        if sample: sample(k, s)
        if happened: s.instant()
        elif k % 16 == 0: s.touching()
    return s

if __name__ == '__main__':
    dec = lambda q: repr(float(q)) if math.isfinite(float(q)) and float('%.17g' % q) == float(q) else '%.17g' % q
    def show(k, s):
        for i in range(len(s.name)):
            if s.alive[i]: print(k, s.name[i], *('{:.17g}'.format(float(q)) for q in s.x[i] + s.v[i]), sep=',')
    print('step,name,x,y,vx,vy'); keep = []
    try: s = simulate(open(sys.argv[1]).read(), lambda k, s: (keep.append(s), show(k, s))); rc = 0
    except (Crushed, Endless) as err: s, rc = keep[-1], 1; print(type(err).__name__, err, file=sys.stderr)
    if '--log' in sys.argv:
        for t, i, j, k, vb, va, J in s.log: print(f'{float(t):.17g},{s.name[i]},{s.name[j]},{"xy"[k]},{float(vb):.17g},{float(va):.17g},{float(J):.17g}', file=sys.stderr)
    print('collisions', len(s.log), file=sys.stderr); sys.exit(rc)
