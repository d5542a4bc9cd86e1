#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""demo, build, level, measure and info on the creature: what they write and say fits together."""
import itertools
import json
import os
import shutil
import struct
import tempfile

from support import Case, main, run

FRAMES = 6
DEMO = ["--frame-count", FRAMES, "--resolution", 32, "--samples", 300]
INPUT = ["creature.obj", "--cache", "creature.pc2"]


def setUpModule():
    global FOLDER, SUMMARY
    FOLDER = tempfile.mkdtemp()
    case = Case()
    SUMMARY = case.json("demo", "-o", FOLDER, *DEMO)


def tearDownModule():
    shutil.rmtree(FOLDER)


def content(name):
    with open(os.path.join(FOLDER, name), "rb") as file:
        return file.read()


class InFolder(Case):
    def succeeds(self, *arguments, cwd=None):
        return super().succeeds(*arguments, cwd=cwd or FOLDER)

    def refuses(self, code, culprit, *arguments, cwd=None):
        return super().refuses(code, culprit, *arguments, cwd=cwd or FOLDER)


class Demo(InFolder):
    def test_the_demo_leaves_what_it_says(self):
        names = {"creature.obj", "creature.pc2", "creature.sphm", "creature-qem.sphm", "creature-rig.glb"}
        names |= {f"{m}-{k}.{e}" for m, k, e in
                  itertools.product(("level", "qem"), (60, 40, 20, 10), ("json", "obj"))}
        self.assertLessEqual(names, set(os.listdir(FOLDER)))

    def test_spheres_are_nearer_than_points(self):
        for ours, points in zip(SUMMARY["sphere_mesh"]["levels"], SUMMARY["qem"]["levels"]):
            self.assertEqual(ours["spheres"], points["spheres"])
            self.assertLess(ours["mean12"], points["mean12"])
            self.assertLess(ours["mean21"], points["mean21"])

    def test_the_table_for_people_has_a_row_per_level(self):
        with tempfile.TemporaryDirectory() as folder:
            text = self.succeeds("demo", "-o", os.path.join(folder, "new"), *DEMO, cwd=folder).stdout
        for count in (60, 40, 20, 10):
            self.assertRegex(text, rf"(?m)^{count} ( +\d+\.\d+){{6}}$")

    def test_a_folder_that_cannot_be_made_is_named(self):
        self.refuses(1, "creature.obj", "demo", "-o", "creature.obj", *DEMO)

    def test_the_creature_is_closed_manifold_outward_and_one_piece_at_every_resolution(self):
        with tempfile.TemporaryDirectory() as folder:
            for resolution in (33, 41, 48):
                self.succeeds("demo", "-o", folder, "--frame-count", 3, "--resolution", resolution, "--samples", 1,
                              "--quiet")
                info = self.json("info", *INPUT, cwd=folder)
                self.assertEqual(info["frames"], 3)
                self.assertEqual(info["triangles"], 2 * info["vertices"] - 4)  # Euler: a sphere's topology
                self.assertEqual({k: v for k, v in info["check"].items() if v}, {"components": 1})

    def test_the_creature_keeps_its_volume_within_a_hundredth(self):
        triangles = [[int(part.split("/")[0]) - 1 for part in line.split()[1:]]
                     for line in content("creature.obj").decode().splitlines() if line.startswith("f ")]
        cache = content("creature.pc2")
        count = int.from_bytes(cache[16:20], "little")
        values = memoryview(cache[32:]).cast("f")
        volumes = []
        for frame in range(FRAMES):
            base, volume = 3 * count * frame, 0.0
            for a, b, c in triangles:
                p, q, r = (values[base + 3 * i:base + 3 * i + 3] for i in (a, b, c))
                volume += (p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2])
                           + p[2] * (q[0] * r[1] - q[1] * r[0])) / 6
            volumes.append(volume)
        self.assertGreater(min(volumes), 0.4)
        self.assertLess(max(volumes) / min(volumes), 1.01)


class RoundTrip(InFolder):
    def test_build_gives_the_hierarchy_of_the_demo_for_any_number_of_threads(self):
        for threads in (1, 2):
            self.succeeds("build", *INPUT, "-o", f"t{threads}.sphm", "--threads", threads)
            self.assertEqual(content(f"t{threads}.sphm"), content("creature.sphm"))

    def test_build_s_figures_fit_its_input(self):
        info, built = self.json("info", *INPUT), self.json("build", *INPUT, "-o", "b.sphm")
        for key in ("vertices", "triangles", "frames"):
            self.assertEqual(built[key], info[key])
        self.assertAlmostEqual(built["bounding_diagonal"], info["bounding_diagonal"], 5)
        self.assertEqual(built["spheres_min"], 1)
        self.assertEqual(built["collapses"], built["vertices"] - 1)
        self.assertLessEqual(built["first_forced"], built["collapses"])
        self.assertEqual(built["bytes"], len(content("b.sphm")))
        self.assertGreater(built["evaluations"], built["vertices"])
        self.assertGreater(built["peak_rss_bytes"], 1 << 20)
        self.assertAlmostEqual(built["build_s"], built["init_s"] + built["decimate_s"], 9)
        for key in ("load_s", "init_s", "decimate_s", "save_s"):
            self.assertGreaterEqual(built[key], 0)

    def test_a_level_has_the_shape_that_was_asked_for(self):
        told = self.json("level", "creature.sphm", "--spheres", 33, "-o", "l.json")
        level = json.loads(content("l.json"))
        self.assertEqual((level["format"], level["version"]), ("sphmesh-level", 1))
        self.assertEqual((level["spheres"], level["frames"]), (33, FRAMES))
        self.assertEqual(len(level["centers"]), FRAMES)
        self.assertTrue(all(len(frame) == 33 for frame in level["centers"]))
        self.assertEqual(len(level["radii"]), 33)
        self.assertEqual((told["edges"], told["triangles"]), (len(level["edges"]), len(level["triangles"])))
        self.assertTrue(all(0 <= i < 33 for t in level["triangles"] + level["edges"] for i in t))
        info = self.json("info", "l.json")
        self.assertEqual((info["kind"], info["spheres"], info["triangles"]), ("level", 33, told["triangles"]))

    def test_a_level_by_error_is_the_coarsest_that_is_good_enough(self):
        hierarchy = self.json("info", "creature.sphm")
        self.assertEqual(hierarchy["kind"], "hierarchy")
        row = next(r for r in hierarchy["levels"] if r["spheres"] == 40)
        told = self.json("level", "creature.sphm", "--max-error", 1.0000001 * row["error_percent"], "-o", "e.sphm")
        self.assertLessEqual(told["spheres"], 40)
        self.assertLessEqual(told["error_percent"], 1.0000001 * row["error_percent"])
        self.assertEqual(self.json("info", "e.sphm")["spheres"], told["spheres"])

    def test_the_surface_of_a_level_is_closed_manifold_and_outward(self):
        self.succeeds("level", "creature.sphm", "--spheres", 20, "-o", "s.sphm")
        for ending in ("obj", "ply"):
            told = self.json("surface", "s.sphm", "--frame", 1, "--resolution", 60, "-o", "s." + ending)
            info = self.json("info", "s." + ending)
            self.assertEqual((info["vertices"], info["triangles"]), (told["vertices"], told["triangles"]))
            wrong = {k: v for k, v in info["check"].items() if v and k not in ("components", "degenerate_triangles")}
            self.assertEqual(wrong, {})
        self.refuses(1, "first_frame is 999", "surface", "s.sphm", "--frame", 999, "-o", "no.ply")
        self.refuses(1, "memory_limit", "surface", "s.sphm", "--memory", 1, "--resolution", 500, "-o", "no.ply")
        self.refuses(1, "holds a hierarchy", "surface", "creature.sphm", "-o", "no.ply")
        self.refuses(2, "'no.txt' does not end in", "surface", "s.sphm", "-o", "no.txt")
        self.assertFalse(os.path.exists(os.path.join(FOLDER, "no.ply")))

    def test_optimized_connectivity_keeps_the_spheres(self):
        self.succeeds("level", "creature.sphm", "--spheres", 30, "-o", "plain.json")
        self.succeeds("level", "creature.sphm", "--spheres", 30, "-o", "dual.json", "--optimize-connectivity")
        plain, dual = json.loads(content("plain.json")), json.loads(content("dual.json"))
        self.assertEqual((plain["centers"], plain["radii"]), (dual["centers"], dual["radii"]))
        self.assertGreater(len(dual["triangles"]), 0)
        self.assertNotEqual(plain["labels"], dual["labels"])

    def test_casts_hit_the_level_on_its_spheres(self):
        level = json.loads(content("level-20.json"))
        with open(os.path.join(FOLDER, "rays.txt"), "w") as file:
            file.write("# to the centres, from afar\n\n")
            for x, y, z in level["centers"][2]:
                file.write(f"{x} {y} {z + 100} {x} {y} {z - 100}  # and through\n")
            file.write("500 500 500 600 600 600 0.5\n")
        told = self.json("cast", "level-20.json", "--rays", "rays.txt", "--frame", 2, "--radius", 0.001)
        self.assertEqual((told["casts"], told["hits"]), (21, 20))
        self.assertFalse(told["answers"][-1]["hit"])
        for (x, y, z), answer in zip(level["centers"][2], told["answers"]):
            self.assertAlmostEqual(z + 100 - 200 * answer["s"], answer["point"][2] + 0.001 * answer["normal"][2], 4)
            self.assertAlmostEqual(sum(answer["weights"]), 1)
            self.assertAlmostEqual(sum(n * n for n in answer["normal"]), 1)
            self.assertLess(answer["s"], 0.5)
        lines = self.succeeds("cast", "level-20.json", "--rays", "rays.txt", "--frame", "1.5").stdout.splitlines()
        self.assertEqual(len(lines), 21)
        self.assertEqual(lines[-1], "-")
        self.refuses(1, "frame 99", "cast", "level-20.json", "--rays", "rays.txt", "--frame", 99)
        with open(os.path.join(FOLDER, "bad.txt"), "w") as file:
            file.write("0 0 0 1 1 1\n1 2 3 4 5\n")
        self.refuses(1, "bad.txt:2", "cast", "level-20.json", "--rays", "bad.txt")
        self.refuses(1, "nowhere.txt", "cast", "level-20.json", "--rays", "nowhere.txt")
        self.refuses(2, "--rays", "cast", "level-20.json")

    def test_measures_agree_with_the_demo_s_and_with_themselves(self):
        told = self.json("measure", *INPUT, "--level", "level-40.json", "--samples", 300)
        demo = next(r for r in SUMMARY["sphere_mesh"]["levels"] if r["spheres"] == 40)
        for key in ("hausdorff", "mean12", "mean21", "max12", "max21"):
            self.assertAlmostEqual(told[key], demo[key], 3)
            self.assertAlmostEqual(told[key], 100 * told["model_units"][key] / told["bounding_diagonal"], 9)
        self.assertEqual((told["frames"], told["samples"], told["spheres"]), (FRAMES, 300, 40))
        self.assertGreaterEqual(told["max12"], told["mean12"])

    def test_frames_pick_frames_of_both_or_of_the_input_that_a_level_was_built_from(self):
        told = self.json("measure", *INPUT, "--level", "level-20.json", "--samples", 100, "--frames", "1::2")
        self.assertEqual(told["frames"], 3)
        built = self.json("build", *INPUT, "--frames", "1::2", "-o", "odd.sphm")
        self.assertEqual(built["frames"], 3)
        self.succeeds("level", "odd.sphm", "--spheres", 20, "-o", "odd.json")
        told = self.json("measure", *INPUT, "--level", "odd.json", "--samples", 100, "--frames", "1::2")
        self.assertEqual(told["frames"], 3)
        self.assertLess(told["mean12"], 5)
        self.refuses(1, str(FRAMES), "measure", *INPUT, "--level", "odd.json")

    def test_build_s_choices_reach_the_result(self):
        seen = {content("creature.sphm")}
        for choice in (["--radius", "zero"], ["--radius", "per-frame"], ["--importance", "none"],
                       ["--radius-factor", "0.2"], ["--temporal-coherence", "0.1"], ["--scale", "2"], ["--up", "z"]):
            self.succeeds("build", *INPUT, "-o", "choice.sphm", *choice)
            self.assertNotIn(content("choice.sphm"), seen, choice)
            seen.add(content("choice.sphm"))
        self.succeeds("build", *INPUT, "-o", "choice.sphm", "--radius", "zero")
        self.assertEqual(content("choice.sphm"), content("creature-qem.sphm"))

    def test_a_count_that_the_hierarchy_does_not_have_is_refused(self):
        self.refuses(2, "--spheres: 999999", "level", "creature.sphm", "--spheres", 999999, "-o", "no.json")
        self.assertFalse(os.path.exists(os.path.join(FOLDER, "no.json")))

    def test_a_level_where_a_hierarchy_is_needed_is_refused_and_the_other_way_round(self):
        self.succeeds("level", "creature.sphm", "--spheres", 12, "-o", "twelve.sphm")
        self.refuses(1, "twelve.sphm", "level", "twelve.sphm", "--spheres", 4, "-o", "no.json")
        self.refuses(1, "creature.sphm", "measure", *INPUT, "--level", "creature.sphm")

    def test_welding_joins_a_seam(self):
        with open(os.path.join(FOLDER, "seam.obj"), "w") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n" * 2)  # a tetrahedron whose faces share no vertex of two
            file.write("f 1 3 2\nf 1 2 4\nf 6 7 8\nf 5 8 7\n")
        self.assertEqual(self.json("build", "seam.obj", "-o", "seam.sphm")["spheres_min"], 2)
        built = self.json("build", "seam.obj", "-o", "seam.sphm", "--weld")
        self.assertEqual((built["spheres_min"], built["welded"], built["vertices"]), (1, 4, 4))
        self.assertIn("--weld", self.succeeds("info", "seam.obj").stdout)


class Convert(InFolder):
    def test_there_and_back_again_gives_the_same_bytes(self):
        told = self.json("convert", *INPUT, "-o", "a.mdd", "--fps", 25)
        self.assertEqual((told["mesh"], told["cache"], told["frames"]), ("a.obj", "a.mdd", FRAMES))
        self.assertEqual(told["bytes"], len(content("a.obj")) + len(content("a.mdd")))
        mdd = content("a.mdd")
        self.assertEqual(struct.unpack(f">2i{FRAMES}f", mdd[:8 + 4 * FRAMES])[2:],
                         struct.unpack(f"{FRAMES}f", struct.pack(f"{FRAMES}f", *(f / 25 for f in range(FRAMES)))))
        self.succeeds("convert", "a.obj", "--cache", "a.mdd", "-o", "b.obj")
        self.assertEqual(content("b.obj"), content("creature.obj"))
        self.assertEqual(content("b.pc2"), content("creature.pc2"))
        self.succeeds("convert", *INPUT, "--frames", "2:5:2", "-o", "c.PC2")
        self.assertEqual(self.json("info", "c.obj", "--cache", "c.PC2")["frames"], 2)

    def test_sequences_of_every_format_become_the_same_cache(self):
        frames = [[(0, 0, 0), (1, 0, f), (1, 1, 0), (0, 1, 0.5 * f)] for f in range(11)]
        faces = [(0, 1, 2), (0, 2, 3)]
        text = [[" ".join(map(str, v)) for v in frame] for frame in frames]
        for f, (frame, lines) in enumerate(zip(frames, text)):
            header = "\n".join(["ply", "format binary_big_endian 1.0", "element vertex 4", *(f"property float {a}"
                               for a in "xyz"), "element face 2", "property list uchar int vertex_index", "end_header\n"])
            data = {"obj": "".join(f"v {v}\n" for v in lines) + "f 1 2 3 4\n",
                    "off": "OFF\n4 1 0\n" + "\n".join(lines) + "\n4 0 1 2 3\n",
                    "stl": "solid\n" + "".join("facet normal 0 0 0\nouter loop\n" + "".join(
                        f"vertex {lines[i]}\n" for i in t) + "endloop\nendfacet\n" for t in faces) + "endsolid\n",
                    "ply": header.encode() + b"".join(struct.pack(">3f", *v) for v in frame)
                           + b"".join(struct.pack(">B3i", 3, *t) for t in faces)}
            for ending, bytes_ in data.items():
                with open(os.path.join(FOLDER, f"frame{f}.{ending}"), "wb") as file:
                    file.write(bytes_ if isinstance(bytes_, bytes) else bytes_.encode())
        for ending in ("obj", "off", "stl", "ply"):
            told = self.json("convert", f"frame*.{ending}", "-o", f"to-{ending}.obj")
            self.assertEqual((told["vertices"], told["triangles"], told["frames"]), (4, 2, 11))
            self.assertEqual(content(f"to-{ending}.obj"), content("to-obj.obj"))
            values = struct.unpack("<132f", content(f"to-{ending}.pc2")[32:])
            self.assertEqual(list(values), [x for frame in frames for v in frame for x in v])

    def test_welding_unites_what_coincides(self):
        with open(os.path.join(FOLDER, "two.off"), "w") as file:
            file.write("OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 3 4 5\n")
        self.assertEqual(self.json("convert", "two.off", "-o", "two.obj")["vertices"], 6)
        self.assertEqual(self.json("convert", "two.off", "-o", "two.obj", "--weld")["vertices"], 4)

    def test_a_level_as_ply_is_frame_0_of_the_level(self):
        self.succeeds("level", "creature.sphm", "--spheres", 33, "-o", "p.json")
        self.succeeds("level", "creature.sphm", "--spheres", 33, "-o", "p.ply")
        level = json.loads(content("p.json"))
        header, body = content("p.ply").decode().split("end_header\n")
        for line in ("format ascii 1.0", "element vertex 33", "property float radius",
                     f"element face {len(level['triangles'])}", f"element edge {len(level['edges'])}"):
            self.assertIn(line + "\n", header)
        rows = [list(map(float, line.split())) for line in body.splitlines()]
        self.assertEqual(rows[:33], [c + [r] for c, r in zip(level["centers"][0], level["radii"])])
        self.assertEqual(rows[33:], [[3, *t] for t in level["triangles"]] + level["edges"])
        self.assertEqual(self.json("info", "p.ply")["vertices"], 33)


class Output(InFolder):
    WORK = [["convert", *INPUT, "-o", "o.obj"],
            ["build", *INPUT, "-o", "o.sphm"], ["info", *INPUT], ["info", "creature.sphm"], ["info", "level-10.json"],
            ["level", "creature.sphm", "--spheres", "9", "-o", "o.json"],
            ["measure", *INPUT, "--level", "level-10.json", "--samples", "50"]]

    def test_quiet_is_quiet(self):
        for work in self.WORK:
            done = self.succeeds(*work, "--quiet", "--progress", "plain")
            self.assertEqual((done.stdout, done.stderr), ("", ""), work)

    def test_progress_stays_off_stdout(self):
        for work in self.WORK:
            plain = self.succeeds(*work, "--progress", "plain")
            self.assertNotIn("%,", plain.stdout)
            self.assertEqual(self.succeeds(*work, "--progress", "none").stderr, "")
            json.loads(self.succeeds(*work, "--json", "--progress", "bar").stdout)

    def test_progress_as_json_is_one_object_a_line_and_never_falls(self):
        done = self.succeeds("build", *INPUT, "-o", "o.sphm", "--progress", "json")
        last = {}
        for line in done.stderr.splitlines():
            told = json.loads(line)
            self.assertGreaterEqual(told["fraction"], last.get(told["task"], 0))
            last[told["task"]] = told["fraction"]
        self.assertIn("building", last)

    def test_progress_is_silent_where_stderr_is_no_terminal(self):
        self.assertEqual(self.succeeds(*self.WORK[1]).stderr, "")

    def test_an_output_that_cannot_be_written_is_named(self):
        self.refuses(1, "no/such/folder", "level", "creature.sphm", "--spheres", 9, "-o", "no/such/folder/o.json")


if __name__ == "__main__":
    main()
