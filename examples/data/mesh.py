#!/usr/bin/env python3
"""Mesh the drafted pattern pieces ahead of time: python3 mesh.py tshirt.json tshirt.obj [edge length in mm]

Needs gmsh on the path; nothing else.  The examples only read the OBJ that this script leaves behind.

The draft draws every piece of the body with x to the wearer's left, so its back is seen through the body and its
sleeve lies with the wrong side up for the left arm.  A sewn garment needs the right side of every piece outside, so
here the back and the left sleeve are turned over (x -> -x in the pattern) and the right sleeve is the mirror image of
the left one.  After that every outline runs counter-clockwise seen from outside, two sewn edges always run against
each other, and the welded garment is one orientable surface.  The last part of the script checks exactly that.
"""
import json
import math
import os
import subprocess
import sys
import tempfile

TURNED_OVER = ('back', 'sleeve_l')


def length(points):
    return sum(math.dist(a, b) for a, b in zip(points, points[1:]))


def resample(points, count):
    """`count` segments of equal arc length along a polyline; the end points stay exactly where they are."""
    total, result, walked, j = length(points), [points[0]], 0.0, 0
    for k in range(1, count):
        want = total * k / count
        while walked + math.dist(points[j], points[j + 1]) < want:
            walked += math.dist(points[j], points[j + 1])
            j += 1
        f = (want - walked) / math.dist(points[j], points[j + 1])
        result.append([a + f * (b - a) for a, b in zip(points[j], points[j + 1])])
    return result + [points[-1]]


def edge_points(piece, edge):
    n, i, result = len(piece['points']), edge['first'], [piece['points'][edge['first']]]
    while i != edge['last']:
        i = (i + 1) % n
        result.append(piece['points'][i])
    return result


def triangulate(outline, h):
    """gmsh's frontal mesher inside a fixed outline; vertices 0 .. len(outline) - 1 are the outline itself."""
    n = len(outline)
    geo = [f'Mesh.Algorithm=6; Mesh.MeshSizeMax={1.05 * h}; Mesh.MshFileVersion=2.2; Mesh.Optimize=1;']
    geo += [f'Point({i + 1})={{{x:.6f},{y:.6f},0,{h}}};' for i, (x, y) in enumerate(outline)]
    geo += [f'Line({i + 1})={{{i + 1},{(i + 1) % n + 1}}};' for i in range(n)]
    geo += [f'Transfinite Curve {{1:{n}}} = 2; Curve Loop(1)={{1:{n}}}; Plane Surface(1)={{1}};']
    with tempfile.TemporaryDirectory() as folder:
        source, target = os.path.join(folder, 'a.geo'), os.path.join(folder, 'a.msh')
        with open(source, 'w') as f:
            f.write('\n'.join(geo) + '\n')
        subprocess.run(['gmsh', '-2', '-v', '1', '-o', target, source], check=True)
        with open(target) as f:
            lines = f.read().split('\n')
    at = lines.index('$Nodes')
    vertices, number = [], {}
    for line in lines[at + 2:at + 2 + int(lines[at + 1])]:
        word = line.split()
        number[int(word[0])] = len(vertices)
        vertices.append((float(word[1]), float(word[2])))
    at = lines.index('$Elements')
    triangles = []
    for line in lines[at + 2:at + 2 + int(lines[at + 1])]:
        word = [int(w) for w in line.split()]
        if word[1] == 2:
            triangles.append([number[w] for w in word[-3:]])
    assert all(math.dist(vertices[i], outline[i]) < 1e-6 for i in range(n))
    for t in triangles:
        a, b, c = (vertices[i] for i in t)
        if (b[0] - a[0]) * (c[1] - a[1]) < (b[1] - a[1]) * (c[0] - a[0]):
            t[1], t[2] = t[2], t[1]
    return vertices, triangles


def turn_over(vertices, triangles, edges):
    return ([(-x, y) for x, y in vertices], [[a, c, b] for a, b, c in triangles],
            {name: chain[::-1] for name, chain in edges.items()})


def check(pieces, seams):
    """Weld all seams; every interior edge must be run through once in each direction.  Reports sizes and eases."""
    base, total = {}, 0
    for name, (vertices, _, _) in pieces.items():
        base[name] = total
        total += len(vertices)
    parent = list(range(total))

    def root(i):
        while parent[i] != i:
            i = parent[i]
        return i

    for (pa, ea), (pb, eb), direction in seams:
        a, b = pieces[pa][2][ea], pieces[pb][2][eb]
        assert len(a) == len(b) and direction == 'reverse'
        la, lb = (length([pieces[p][0][i] for i in chain]) for p, chain in ((pa, a), (pb, b)))
        print(f'  seam {pa}.{ea} {pb}.{eb}: {len(a) - 1} segments, {la:.1f} mm on {lb:.1f} mm,'
              f' ease {100 * (la - lb) / lb:+.2f} %')
        for i, j in zip(a, b[::-1]):
            parent[root(base[pa] + i)] = root(base[pb] + j)
    directed, faces = {}, 0
    for name, (_, triangles, _) in pieces.items():
        for t in triangles:
            w = [root(base[name] + i) for i in t]
            assert len(set(w)) == 3, 'a triangle collapses in the weld'
            faces += 1
            for k in range(3):
                e = (w[k], w[(k + 1) % 3])
                assert e not in directed, 'two triangles run the same way along an edge: not orientable or not manifold'
                directed[e] = True
    border = {a: b for a, b in directed if (b, a) not in directed}
    assert len(border) == sum((b, a) not in directed for a, b in directed), 'border touches itself'
    loops, left = 0, set(border)
    while left:
        i = left.pop()
        j = border[i]
        while j != i:
            left.remove(j)
            j = border[j]
        loops += 1
    points = len({root(i) for i in range(total)})
    euler = points - len({tuple(sorted(e)) for e in directed}) + faces
    print(f'  {total} vertices, {points} after the weld, {faces} triangles, {loops} border loops, Euler number {euler}')
    assert euler == 2 - loops, 'the welded garment is not a sphere with holes'


def quality(vertices, triangles):
    smallest = []
    for t in triangles:
        corner = [vertices[i] for i in t]
        angles = []
        for k in range(3):
            u = [corner[(k + 1) % 3][i] - corner[k][i] for i in (0, 1)]
            v = [corner[(k + 2) % 3][i] - corner[k][i] for i in (0, 1)]
            angles.append(math.degrees(math.acos((u[0] * v[0] + u[1] * v[1]) / math.hypot(*u) / math.hypot(*v))))
        smallest.append(min(angles))
    return f'smallest angle {min(smallest):.1f}, mean of the smallest {sum(smallest) / len(smallest):.1f} degrees'


def main():
    source, target = sys.argv[1], sys.argv[2]
    h = float(sys.argv[3]) if len(sys.argv) > 3 else 22.0
    with open(source) as f:
        pattern = json.load(f)
    drafted = {p['name']: p for p in pattern['pieces']}
    original = {n: p.get('mirror_of', n) for n, p in drafted.items()}

    # The same number of segments on both sides of every seam, and on a piece and its mirror image.
    count = {(n, e['name']): max(1, round(e['length_mm'] / h)) for n, p in drafted.items() for e in p.get('edges', [])}
    for s in pattern['seams']:
        a, b = ((original[p], e) for p, e in (s['a'], s['b']))
        count[a] = count[b] = max(count[a], count[b])

    pieces, place = {}, {}
    for n, p in drafted.items():
        if 'mirror_of' in p:
            pieces[n] = turn_over(*pieces[p['mirror_of']])
        else:
            outline, edges = [], {}
            for e in p['edges']:
                chain = resample(edge_points(p, e), count[(n, e['name'])])
                edges[e['name']] = list(range(len(outline), len(outline) + len(chain)))
                outline += chain[:-1]
            edges = {name: [i % len(outline) for i in chain] for name, chain in edges.items()}
            vertices, triangles = triangulate(outline, h)
            print(f'  {n}: {quality(vertices, triangles)}')
            pieces[n] = (vertices, triangles, edges)
            if n in TURNED_OVER:
                pieces[n] = turn_over(*pieces[n])
        place[n] = n if n.startswith('sleeve') else p['place']
    seams = [(tuple(s['a']), tuple(s['b']), 'reverse') for s in pattern['seams']]
    check(pieces, seams)

    src = pattern['source']
    with open(target, 'w') as f:
        f.write(f"# {pattern['garment']}, drafted by FreeSewing {src['package']} {src['version']} ({src['license']}),"
                f" measurements {src['measurements_set']}, edge length {h:g} mm\n"
                '# v: the pieces laid flat, in m.  vt: pattern coordinates (the rest shape), in m.  One object per piece.\n'
                '# The right side of the cloth is the counter-clockwise one.  Vertex numbers in comments are global, from 1.\n'
                '# Lines edge PIECE EDGE VERTEX...: along the outline, counter-clockwise.\n'
                '# Lines seam PIECE EDGE PIECE EDGE reverse: the first vertex of one edge is sewn to the last of the other.\n')
        base, offset = 1, 0.0
        for n, (vertices, triangles, edges) in pieces.items():
            low = min(x for x, _ in vertices)
            f.write(f'o {n}\n# place {n} {place[n]}\n')
            f.writelines(f'v {(x - low + offset) / 1000:.5f} {y / 1000:.5f} 0\n' for x, y in vertices)
            f.writelines(f'vt {x / 1000:.5f} {y / 1000:.5f}\n' for x, y in vertices)
            f.writelines('f ' + ' '.join(f'{base + i}/{base + i}' for i in t) + '\n' for t in triangles)
            for name, chain in edges.items():
                f.write(f'# edge {n} {name} ' + ' '.join(str(base + i) for i in chain) + '\n')
            base += len(vertices)
            offset += max(x for x, _ in vertices) - low + 60
        for (pa, ea), (pb, eb), direction in seams:
            f.write(f'# seam {pa} {ea} {pb} {eb} {direction}\n')


main()
