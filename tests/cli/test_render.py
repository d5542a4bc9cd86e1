#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Pictures: what is where on them, for scenes whose picture is known from geometry alone."""
import json
import math
import os
import shutil
import struct
import tempfile
import zlib

from support import Case, main, run

HAS_RENDER = run("help", "render").returncode == 0  # not where the program was built without libpng
CREATURE = ["creature.obj", "--cache", "creature.pc2"]
SIZE = 60


def setUpModule():
    global FOLDER
    FOLDER = tempfile.mkdtemp()
    if HAS_RENDER:
        Case().succeeds("demo", "-o", FOLDER, "--frame-count", 6, "--resolution", 32, "--samples", 10, "--quiet")
    level("ball", [[[0, 0, 0]]], [1])
    level("capsule", [[[-4, 0, 0], [4, 0, 0]]], [1, 1], edges=[[0, 1]])
    level("slab", [[[-4, -3, 0], [4, -3, 0], [0, 4, 0]]], [0, 0, 0], triangles=[[0, 1, 2]])
    level("walk", [[[0, 0, 0]], [[30, 0, 0]]], [1])
    with open(os.path.join(FOLDER, "square.obj"), "w") as file:
        file.write("v -2 -2 0\nv 2 -2 0\nv 2 2 0\nv -2 2 0\nf 1 2 3\nf 1 3 4\n")


def tearDownModule():
    shutil.rmtree(FOLDER)


def level(name, centers, radii, edges=(), triangles=()):
    text = {"format": "sphmesh-level", "version": 1, "frames": len(centers), "spheres": len(radii), "radii": radii,
            "centers": centers, "edges": list(edges), "triangles": list(triangles), "labels": []}
    with open(os.path.join(FOLDER, name + ".json"), "w") as file:
        json.dump(text, file)


def content(name):
    with open(os.path.join(FOLDER, name), "rb") as file:
        return file.read()


def decode(data):
    """Rows of (r, g, b) of a PNG of 8-bit RGB, by the format's own rules."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    place, packed = 8, b""
    while place < len(data):
        length, kind = struct.unpack(">I4s", data[place:place + 8])
        body = data[place + 8:place + 8 + length]
        assert struct.unpack(">I", data[place + 8 + length:place + 12 + length])[0] == zlib.crc32(kind + body)
        if kind == b"IHDR":
            width, height, *how = struct.unpack(">IIBBBBB", body)
            assert how == [8, 2, 0, 0, 0]
        packed += body if kind == b"IDAT" else b""
        place += 12 + length
    raw, rows, above = zlib.decompress(packed), [], [0] * (3 * width)
    for y in range(height):
        line = raw[y * (3 * width + 1):(y + 1) * (3 * width + 1)]
        row = []
        for i, byte in enumerate(line[1:]):
            a, b, c = row[i - 3] if i >= 3 else 0, above[i], above[i - 3] if i >= 3 else 0
            p = a + b - c
            paeth = min((a, b, c), key=lambda v: abs(p - v))
            row.append((byte + (0, a, b, (a + b) // 2, paeth)[line[0]]) & 255)
        above = row
        rows.append([tuple(row[i:i + 3]) for i in range(0, 3 * width, 3)])
    return rows


def colour(pixel):
    r, g, b = pixel
    if min(pixel) > 245:
        return "white"
    if max(pixel) - min(pixel) < 30:
        return "grey"
    if b > r and b > g:
        return "blue"
    return "yellow" if g > 0.55 * r else "red"


class Drawing(Case):
    def setUp(self):
        if not HAS_RENDER:
            self.skipTest("the program was built without libpng")

    def draw(self, *arguments, size=SIZE):
        self.succeeds("render", *arguments, "--size", size, "-o", "out.png", "--quiet", cwd=FOLDER)
        return decode(content("out.png"))

    def refuses(self, code, culprit, *arguments):
        done = super().refuses(code, culprit, "render", *arguments, "-o", "no.png", cwd=FOLDER)
        self.assertFalse(os.path.exists(os.path.join(FOLDER, "no.png")))
        return done

    def covered(self, rows):
        return [(x, y) for y, row in enumerate(rows) for x, pixel in enumerate(row) if colour(pixel) != "white"]


class Geometry(Drawing):
    def test_a_ball_is_a_red_disc_of_the_area_it_has(self):
        for view in ("front", "side", "back", "top", "corner"):
            rows = self.draw("ball.json", "--view", view, "--flat")
            cells = self.covered(rows)
            self.assertEqual({colour(rows[y][x]) for x, y in cells if (x - 29.5) ** 2 + (y - 29.5) ** 2 < 200}, {"red"})
            radius = math.sqrt(len(cells) / math.pi)
            if view != "corner":  # from there the box, of side 2, looks wider
                self.assertAlmostEqual(radius, SIZE / 2 / 1.08, delta=1)
            self.assertLess(abs(sum(x for x, _ in cells) / len(cells) - 29.5), 0.2)
            self.assertLess(abs(sum(y for _, y in cells) / len(cells) - 29.5), 0.2)

    def test_spheres_are_red_edges_yellow_triangles_blue(self):
        rows = self.draw("capsule.json", "--view", "front", "--flat")
        self.assertEqual([colour(rows[29][x]) for x in (1, 5, 20, 30, 40, 55, 58)],
                         ["white", "red", "yellow", "yellow", "yellow", "red", "white"])
        rows = self.draw("slab.json", "--view", "front", "--flat", size=300)
        edge = next(y for y in range(299, 0, -1) if colour(rows[y][150]) != "white")
        self.assertEqual([colour(rows[y][150]) for y in (160, edge - 20, edge - 1)], ["blue", "blue", "yellow"])
        corner = min(x for x in range(300) if colour(rows[edge - 1][x]) != "white")
        self.assertEqual(colour(rows[edge - 1][corner + 1]), "red")

    def test_sheets_of_no_thickness_have_no_speckles_from_either_side(self):
        for azimuth in (0, 20, 180, 200):
            rows = self.draw("slab.json", "--azimuth", azimuth, "--flat")
            inner = [rows[y][x] for y in range(32, 38) for x in range(26, 35)]
            self.assertEqual({colour(pixel) for pixel in inner}, {"blue"})
            for k in range(3):
                self.assertLessEqual(max(p[k] for p in inner) - min(p[k] for p in inner), 2)

    def test_a_mesh_is_drawn_grey_and_as_wide_as_it_is(self):
        rows = self.draw("square.obj", "--view", "front", "--flat")
        cells = self.covered(rows)
        self.assertEqual({colour(rows[y][x]) for x, y in cells if 6 < x < 53 and 6 < y < 53}, {"grey"})
        self.assertAlmostEqual(math.sqrt(len(cells)), SIZE / 1.08, delta=1)

    def test_scale_changes_nothing_and_the_up_axis_turns_the_mesh(self):
        plain = self.draw("square.obj", "--view", "front", "--flat")
        self.assertTrue(self.draw("square.obj", "--view", "front", "--flat", "--scale", 4) == plain)
        above = self.covered(self.draw("square.obj", "--view", "top", "--flat", "--up", "z"))
        self.assertLess(len(set(above) ^ set(self.covered(plain))), 0.03 * len(above))
        self.assertEqual(self.covered(self.draw("square.obj", "--view", "front", "--flat", "--up", "z")), [])

    def test_more_samples_make_edges_softer(self):
        def paleness(samples):  # pixels of the rim that are partly covered
            rows = self.draw("ball.json", "--view", "front", "--flat", "--samples", samples)
            rim = [rows[y][x] for y in range(SIZE) for x in range(SIZE) if (x - 29.5) ** 2 + (y - 29.5) ** 2 > 25 ** 2]
            return sum(120 < pixel[1] < 245 and 120 < pixel[2] < 245 for pixel in rim)
        self.assertEqual(paleness(1), 0)
        self.assertGreater(paleness(4), 50)

    def test_zoom_and_center_move_in_on_a_place(self):
        rows = self.draw("capsule.json", "--view", "front", "--flat", "--zoom", 5, "--center", "4,0,0")
        self.assertEqual(colour(rows[30][30]), "red")
        self.assertEqual(colour(rows[30][4]), "yellow")
        self.assertEqual(colour(rows[30][58]), "white")

    def test_perspective_makes_what_is_nearer_larger(self):
        def widths(*how):  # of a long capsule that is seen from above its near end
            rows = self.draw("capsule.json", "--azimuth", 90, "--elevation", 30, "--flat", *how)
            drawn = [sum(colour(p) != "white" for p in row) for row in rows]
            used = [n for n in drawn if n > 4]
            return used[len(used) // 4], used[3 * len(used) // 4]
        far, near = widths()
        self.assertLessEqual(abs(far - near), 1)
        far, near = widths("--focal", 28)
        self.assertGreater(near, far + 3)

    def test_the_overlay_tints_what_it_covers_and_can_be_seen_through(self):
        plain = self.draw("capsule.json", "--view", "front", "--flat", "--center", "0,0,0", "--zoom", 0.5)
        glass = self.draw("capsule.json", "--view", "front", "--flat", "--center", "0,0,0", "--overlay", "square.obj")
        # the square stands within the capsule: it shows above and below it only, and sets the scale
        self.assertEqual(colour(glass[30][30]), "yellow")
        self.assertEqual(colour(glass[8][30]), "grey")
        self.assertEqual(colour(plain[8][30]), "white")
        self.assertGreater(min(glass[8][30]), 120)  # glass, not paint

    def test_the_ground_has_a_shadow_unless_it_is_flat(self):
        with_ground = self.covered(self.draw("ball.json", "--zoom", 0.4, "--elevation", 30))
        flat = self.covered(self.draw("ball.json", "--zoom", 0.4, "--elevation", 30, "--flat"))
        self.assertGreater(len(with_ground), 1.3 * len(flat))
        self.assertLessEqual(set(flat), set(with_ground))


class Sheets(Drawing):
    def test_tiles_are_levels_by_frames(self):
        arguments = ["creature.sphm", "--levels", "20,10", "--frames", "0:3", "--samples", 1]
        told = self.json("render", *arguments, "--size", 40, "-o", "r.png", cwd=FOLDER)
        self.assertEqual([told[k] for k in ("levels", "meshes", "frames", "columns", "rows", "width", "height")],
                         [2, 0, 3, 3, 2, 120, 80])
        whole = decode(content("r.png"))
        self.assertEqual((len(whole), len(whole[0])), (80, 120))
        for row, spheres in enumerate((20, 10)):
            for frame in range(3):
                one = self.draw("creature.sphm", "--levels", spheres, "--frames", frame, "--samples", 1, size=40)
                cut = [line[40 * frame:40 * frame + 40] for line in whole[40 * row:40 * row + 40]]
                self.assertTrue(cut == one)  # to tell all differences would take for ever

    def test_one_frame_puts_levels_side_by_side_and_columns_wrap(self):
        for columns, shape in ((None, (5, 1)), (2, (2, 3)), (9, (5, 1))):
            extra = [] if columns is None else ["--columns", columns]
            told = self.json("render", *CREATURE, "creature.sphm", "creature-qem.sphm", "--levels", "20,10", "--size",
                             "24x16", "--samples", 1, "-o", "r.png", *extra, cwd=FOLDER)
            self.assertEqual((told["columns"], told["rows"]), shape)
            self.assertEqual((told["width"], told["height"]), (24 * shape[0], 16 * shape[1]))
            self.assertEqual((told["levels"], told["meshes"]), (4, 1))

    def test_the_level_lies_where_the_mesh_lies(self):
        mesh = set(self.covered(self.draw(*CREATURE, "--flat")))
        ours = set(self.covered(self.draw("creature.sphm", "--levels", 60, "--flat")))
        self.assertGreater(len(mesh & ours), 0.85 * len(mesh | ours))

    def test_follow_keeps_what_walks_away_in_the_picture(self):
        away = self.covered(self.draw("walk.json", "--frames", 1, "--view", "front", "--flat"))
        self.assertEqual(away, [])
        kept = self.covered(self.draw("walk.json", "--frames", 1, "--view", "front", "--flat", "--follow"))
        self.assertEqual(kept, self.covered(self.draw("ball.json", "--view", "front", "--flat")))

    def test_the_picture_is_the_same_for_any_number_of_threads(self):
        pictures = set()
        for threads in (1, 2, 5):
            self.succeeds("render", *CREATURE, "creature.sphm", "--levels", 20, "--overlay", "creature.obj", "--size",
                          40, "--threads", threads, "-o", "t.png", "--quiet", cwd=FOLDER)
            pictures.add(content("t.png"))
        self.assertEqual(len(pictures), 1)

    def test_input_frames_pick_those_the_level_was_built_from(self):
        self.succeeds("build", *CREATURE, "--frames", "::2", "-o", "half.sphm", "--quiet", cwd=FOLDER)
        over = ["half.sphm", "--levels", 20, "--overlay", "creature.obj", "--cache", "creature.pc2"]
        self.refuses(1, "--input-frames", *over)
        self.draw(*over, "--input-frames", "::2", size=20)


class Clips(Drawing):
    def test_a_clip_is_drawn_at_its_own_frames(self):
        # a triangle that moves up by 3 within a second, linearly
        clip = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
                "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
                "buffers": [{"byteLength": 68, "uri": "rise.bin"}],
                "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 8},
                                {"buffer": 0, "byteOffset": 44, "byteLength": 24}],
                "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                               "max": [4, 4, 0]},
                              {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0],
                               "max": [1]},
                              {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}],
                "animations": [{"name": name, "samplers": [{"input": 1, "output": 2}],
                                "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}
                               for name in ("rise", "again")]}
        with open(os.path.join(FOLDER, "rise.gltf"), "w") as file:
            json.dump(clip, file)
        with open(os.path.join(FOLDER, "rise.bin"), "wb") as file:
            file.write(struct.pack("<17f", 0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 1, 0, 0, 0, 0, 3, 0))

        def lowest(frame, *how):
            return max(y for _, y in self.covered(self.draw("rise.gltf", "--frames", frame, "--flat", "--view", "front",
                                                            "--clip", "rise", *how)))
        self.assertEqual(self.json("render", "rise.gltf", "--fps", 4, "--clip", "rise", "--frames", "::", "--size", 16,
                                   "-o", "c.png", cwd=FOLDER)["frames"], 5)
        # its box is 4 by 4 and its middle 1.5 higher than that of the first frame
        unit = SIZE / (4 * 1.08)
        for frame, fps, height in ((0, 4, 0), (1, 4, 0.75), (4, 4, 3), (1, 2, 1.5)):
            self.assertAlmostEqual(lowest(frame, "--fps", fps), min(SIZE - 1, SIZE / 2 + unit * (2 + 1.5 - height)),
                                   delta=1.1)


class Bones(Drawing):
    def test_bones_colour_the_mesh_and_change_nothing_else(self):
        hues = set()
        plain = self.draw(*CREATURE, "--flat", "--frames", "2")
        coloured = self.draw(*CREATURE, "--flat", "--frames", "2", "--bones", "creature-rig.glb")
        for before, after in zip(plain, coloured):
            for p, q in zip(before, after):
                self.assertEqual(p == (255, 255, 255), q == (255, 255, 255))
                if max(q) - min(q) > 40:
                    hues.add((q.index(max(q)), q.index(min(q))))
        self.assertEqual(len(hues), 6)  # every order of red, green and blue: bones are told apart
        self.refuses(1, "do not belong together", "square.obj", "--bones", "creature-rig.glb")
        self.refuses(2, "no mesh to colour", "ball.json", "--bones", "creature-rig.glb")
        self.refuses(1, "missing.glb", "square.obj", "--bones", "missing.glb")


class Refusals(Drawing):
    def test_a_picture_that_cannot_be_written_is_named(self):
        done = run("render", "ball.json", "-o", "none/r.png", cwd=FOLDER)
        self.assertEqual(done.returncode, 1)
        self.assertIn("none/r.png: cannot be written", done.stderr)
        done = run("render", "ball.json", "-o", "r.jpg", cwd=FOLDER)
        self.assertEqual(done.returncode, 2)
        self.assertIn("'r.jpg' does not end in", done.stderr)

    def test_what_is_not_there_is_named(self):
        self.refuses(1, "has frame 999", "ball.json", "--frames", "999:1000")
        self.refuses(1, "missing.obj", "missing.obj")
        self.refuses(1, "missing.obj", "ball.json", "--overlay", "missing.obj")
        self.refuses(1, "--levels 46,20,10", "creature.sphm")
        self.refuses(1, "sphere", "creature.sphm", "--levels", "100000000")

    def test_what_makes_no_sense_is_wrong_usage(self):
        self.refuses(2, "nothing to draw")
        for text in ("", "0", "4,,2", "4,", "-3", "4 5", "x", "5000000000"):
            self.refuses(2, "--levels: ", "creature.sphm", "--levels", text)
        for text in ("8", "9000", "40x", "x40", "40x8", "1e2"):
            self.refuses(2, "--size: ", "ball.json", "--size", text)
        for text in ("1,2", "1,2,3,4", "1, 2,3", "nan,0,0", "a,b,c"):
            self.refuses(2, "--center: ", "ball.json", "--center", text)
        for option, value in (("--view", "below"), ("--samples", "9"), ("--zoom", "0"), ("--focal", "-1"),
                              ("--columns", "0"), ("--elevation", "91")):
            self.refuses(2, f"{option}: ", "ball.json", option, value)
        self.refuses(2, "one of the two", "ball.json", "--follow", "--center", "0,0,0")
        self.refuses(2, "no level to draw it over", "square.obj", "--overlay", "square.obj")
        self.refuses(2, "is a level", "ball.json", "--overlay", "ball.json")
        self.refuses(2, "no mesh that it could move", "ball.json", "--cache", "creature.pc2")
        self.refuses(1, "too large", "ball.json", "creature.sphm", "--levels", "9,8,7,6,5", "--size", 8192)


if __name__ == "__main__":
    main()
