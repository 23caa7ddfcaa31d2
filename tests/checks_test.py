#!/usr/bin/env python3
"""The checks can fail: each is given a small tree that breaks one rule, and must name it."""
import gzip
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import check_costs
import check_docs
import check_figures
import check_layers
import check_names
import check_shaders

STAGE = "#version 450 core\nlayout(location = 0) out vec4 colour;\n"


class Tree(unittest.TestCase):
    def setUp(self):
        self.root = pathlib.Path(tempfile.mkdtemp(prefix="radiafit-checks-"))
        self.addCleanup(shutil.rmtree, self.root)

    def write(self, path, text):
        path = self.root / path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


class Names(Tree):
    def test_comparisons_with_names_are_found(self):
        for line in ('if (solver == "ceres")', 'return "ceres" != name;', 'x = kind=="ceres" ? 1 : 2;'):
            self.assertEqual(list(check_names.comparisons(line, {"ceres"})), ["ceres"])
        for line in ('set("solver", "ceres");', 'if (name == "vertex")', '.name = "ceres",'):
            self.assertEqual(list(check_names.comparisons(line, {"ceres"})), [])


class Docs(Tree):
    def setUp(self):
        super().setUp()
        self.write("README.md", "# A thing's name\n")
        self.write("src/a/b.h", "int name_of_it();\n")
        self.write("tests/a_test.cpp", "TEST(One, Two) {}\nTEST_P(Many,\n       Three) {}\n")

    def errors(self, text):
        self.write("docs/paper.md", text)
        return check_docs.check(self.root)[0]

    def test_what_is_there_passes(self):
        text = ("## Here, there\n`src/a/b.h`, `src/a`, `src/a/b.h: name_of_it`, `tests/a_test.cpp: One.Two`, "
                "`tests/a_test.cpp: Many.Three`, `--set a/b`\n[a](../README.md) [b](../README.md#a-things-name) "
                "[c](#here-there) [d](https://e.org/f) `x[1](y)`\n")
        self.assertEqual(self.errors(text), [])
        self.assertEqual(check_docs.check(self.root)[1], 5)

    def test_each_missing_thing_is_named(self):
        for text, expected in [
            ("`src/a/c.h`", "docs/paper.md:2: no such file: src/a/c.h"),
            ("`src/a/c.h: x`", "docs/paper.md:2: no such file: src/a/c.h"),
            ("`src/a/b.h: name_of`", "docs/paper.md:2: src/a/b.h has no name_of"),
            ("`src/a: name`", "docs/paper.md:2: no file: src/a"),
            ("`tests/a_test.cpp: One.Three`", "docs/paper.md:2: tests/a_test.cpp has no One.Three"),
            ("[a](../READ.md)", "docs/paper.md:2: no such file: ../READ.md"),
            ("[a](../README.md#things)", "docs/paper.md:2: no such heading: ../README.md#things"),
        ]:
            with self.subTest(text=text):
                self.assertEqual(self.errors("first\n" + text + "\n"), [expected])
        self.write("docs/other.md", "[a](gone.md)\n")
        self.assertEqual(self.errors("first\n"), ["docs/other.md:1: no such file: gone.md"])


class Figures(Tree):
    def setUp(self):
        super().setUp()
        self.add("20260101T000000Z-a", "solver,seconds,share\nours,0.0271,0.917\ntheirs,0.5,0.9984\n")

    def add(self, run, rows, profile="paper", cpu="AMD EPYC (family 26 model 2)", packed=False):
        folder = f"results/reference/solvers/machine/{run}"
        about = {"program": "solvers", "profile": profile, "cpu": cpu, "machine": {"cpu_id": "AuthenticAMD family 26 model 2"}, "wall_s": 60}
        self.write(f"{folder}/run.json", json.dumps(about))
        if packed:
            with gzip.open(self.root / folder / "solvers.csv.gz", "wt", encoding="utf-8") as file:
                file.write(rows)
        else:
            self.write(f"{folder}/solvers.csv", rows)

    def page(self, text, *lines, rows="rows: solvers paper family 26"):
        """README.md with `text` and a comment of `lines` behind it."""
        comment = "\n".join([*([rows] if rows else []), *lines])
        self.write("README.md", f"# Of `solvers`, on family 26\n\n{text}\n<!-- figures\n{comment}\n-->\n")

    def errors(self, write=False):
        return check_figures.check(self.root, write)[0]

    def test_numbers_of_rows_pass(self):
        self.page("Ours takes 27.1 ms and\n91.7 % arrive; theirs 0.50 s, 18 times as long, 18,000 a day, half of a second, in 2 runs, 1 minute, "
                  "1,234 GB, within 1 %. The paper says 5 times.",
                  'one(name) = solvers(solver=name)',
                  'ours = one("ours")',
                  '27.1 ms and 91.7 %: (1000 * ours.seconds, 100 * ours.share)',
                  '0.50 s: one("theirs").seconds',
                  '18 times: one("theirs").seconds / ours.seconds',
                  '18,000: 1000 * one("theirs").seconds / ours.seconds as 2',
                  'half of a second: one("theirs").seconds == 0.5',
                  '2 runs: len(solvers.all("share"))',
                  '1 minute: sum(run.wall_s for run in newest("paper", "family 26")) / 60',
                  '1,234 GB: given', '1 %: given', '5 times: paper')
        self.assertEqual(self.errors(), [])
        self.assertEqual(check_figures.check(self.root)[1:], (8, 1))

    def test_wrong_numbers_are_named_and_written(self):
        self.page("It takes 27.0 ms, then 27.0 ms, of 92 %, 91.70 %.",
                  '27.0 ms: 1000 * solvers(solver="theirs").seconds', '27.0 ms: 1000 * solvers(solver="ours").seconds',
                  '92 %: solvers(solver="ours").share as %', '91.70 %: solvers(solver="theirs").share as %')
        self.assertEqual(self.errors(), ["README.md:3: 27.0 (27.0 ms): the rows say 27.1", "README.md:3: 27.0 (27.0 ms): the rows say 500.0",
                                         "README.md:3: 91.70 (91.70 %): the rows say 99.84"])
        self.assertEqual(self.errors(write=True), [])
        text = (self.root / "README.md").read_text(encoding="utf-8")
        self.assertIn("It takes 500.0 ms, then 27.1 ms, of 92 %, 99.84 %.", text)
        self.assertIn('\n27.1 ms: 1000 * solvers(solver="ours").seconds\n', text)

    def test_the_newest_run_of_a_profile_and_a_machine_counts(self):
        self.page("It takes 3 s.", '3 s: solvers(solver="ours").seconds')
        self.add("20260102T000000Z-b", "solver,seconds\nours,3\n", packed=True)
        self.add("20260103T000000Z-c", "solver,seconds\nours,4\n", profile="standard")
        self.add("20260104T000000Z-d", "solver,seconds\nours,5\n", cpu="AMD EPYC (family 261)")
        (self.root / "results/reference/solvers/machine/20260104T000000Z-d/run.json").write_text(
            '{"program": "solvers", "profile": "paper", "cpu": "AMD EPYC (family 261)"}', encoding="utf-8")
        self.assertEqual(self.errors(), [])

    def test_what_is_missing_is_named(self):
        for lines, expected in [
            (["0.03 s: solvers(solver='other').seconds"], "has no row with solver = other"),
            (["0.03 s: solvers(solver='ours').hours"], "has no column hours"),
            (["0.03 s: solvers.seconds"], "has 2 rows for seconds"),
            (["0.03 s: others.seconds"], "NameError: name 'others' is not defined"),
            (["0.03 s: solvers(solver='ours'"], "SyntaxError"),
            (["0.03 s: solvers(solver='ours').solver"], "no number: ours"),
            (["0.03 s: (1, 2)"], "1 numbers, but 2 values"),
            (["0.03 s: 1 > 2"], "the rows no longer bear it out"),
            (["0.04 s: 1"], "'0.04 s' does not stand above, or not in this order"),
            (["an hour: given", "0.03 s: given"], "'0.03 s' does not stand above, or not in this order"),
            (["0.03 s: once"], "the section does not say 'measured once'"),
            (["0.03 s: tests/a.py"], "tests/a.py has no 0.03"),
            (["0.03 s"], "no 'text: expression': 0.03 s"),
        ]:
            with self.subTest(lines=lines):
                self.write("tests/a.py", "0.031\n")
                self.page("It takes 0.03 s or an hour.", *lines)
                self.assertIn(expected, "\n".join(self.errors()))
        for rows, expected in [("rows: solvers paper family 25", "no run of solvers at the paper profile on 'family 25'"),
                               ("rows: solvers smoke family 26", "no run of solvers at the smoke profile"),
                               ("rows: peers paper family 26", "no run of peers"),
                               ("rows: solvers paper EPYC", "the section does not say 'EPYC'")]:
            with self.subTest(rows=rows):
                self.page("It takes 0.03 s.", "0.03 s: given", rows=rows)
                self.assertIn(expected, "\n".join(self.errors()))

    def test_numbers_that_no_comment_accounts_for_are_named(self):
        for text, number in [("It takes 3 s.", "3"), ("It takes 3 to\n5 minutes.", "3"), ("5.0 and 7 dB", "7"), ("It is ten times as fast.", "ten times"),
                             ("64,000 fits/s", "64,000"), ("It comes to 24.97.", "24.97"), ("- 3 GB", "3"),
                             ("| solver | time |\n|---|---|\n| 7 | 3 |\n", "3")]:
            with self.subTest(text=text):
                self.write("docs/a.md", text + "\n")
                self.assertIn(f"no rows are named for '{number}'", "\n".join(self.errors()))
        for text in ("3 solvers", "`3 s`", "```\n3 s\n```", "    sleep 3 s", "## 3 s", "[a](3.5.md)", "version 1.2.3", "| time |\n|---|\n| a |"):
            with self.subTest(text=text):
                self.write("docs/a.md", text + "\n")
                self.assertEqual(self.errors(), [])
        self.write("docs/a.md", "It takes 3 s.\n<!-- figures\n*: given\n-->\n\nIt takes 3 s.\n")
        self.assertEqual(len(self.errors()), 1)
        self.assertTrue(self.errors()[0].startswith("docs/a.md:6: "), self.errors())


class Layers(Tree):
    def errors(self):
        return check_layers.check(self.root)[0]

    def test_allowed_includes_pass(self):
        self.write("src/core/base/a.h", "#include <vector>\n")
        self.write("src/core/geometry/a.h", '#include "base/a.h"\n#include "geometry/b.h"\n')
        self.write("src/core/gl/a.cpp", '#include <GL/glcorearb.h>\n#include "base/log.h"\n')
        self.write("src/core/fragment/a.cpp", '#include "gl/a.h"\n#include "optim/engine.h"\n#include "optimize/problem_state.glsl"\n')
        self.write("src/core/eval/a.cpp", '#include "fit/fit.h"\n#include "dataset/d.h"\n#include <nlohmann/json.hpp>\n')
        self.write
        self.write("src/tools/cli/CMakeLists.txt", "radiafit_layer(cli LINKS radiafit_gl radiafit_eval)\n")
        self.write("src/core/gl/CMakeLists.txt", "radiafit_layer(gl LINKS radiafit_base EXTERNAL x)\n")
        self.write("src/core/geometry/CMakeLists.txt", "radiafit_layer(geometry LINKS radiafit_base)\n")
        self.write("src/core/eval/CMakeLists.txt", "radiafit_layer(eval LINKS radiafit_fit)\n")
        self.write("src/core/fit/CMakeLists.txt", "radiafit_layer(fit LINKS radiafit_dataset)\n")
        self.assertEqual(self.errors(), [])

    def test_each_forbidden_include_is_named(self):
        cases = [
            ("src/core/base/a.h", '#include "geometry/mesh.h"', "base may not include geometry"),
            ("src/core/model/a.cpp", '#include "dataset/dataset.h"', "model may not include dataset"),
            ("src/core/cpu/a.cpp", '  #  include "gl/program.h"', "cpu may not include gl"),
            ("src/core/gl/a.cpp", '#include "optim/engine.h"', "gl may not include optim"),
            ("src/core/fragment/a.cpp", '#include "reference/ceres.h"', "fragment may not include reference"),
            ("src/core/eval/a.cpp", '#include "optim/solver.h"', "eval may not include optim"),
            ("src/core/fit/a.cpp", '#include "samples/list.h"', "fit may not include samples"),
            ("src/tools/capture/a.cpp", '#include "samples/list.h"', "capture may not include samples"),
            ("src/harness/report/a.cpp", '#include "dataset/dataset.h"', "report may not include dataset"),
            ("src/core/gl/a.cpp", '#include "fitting/family.h"', "gl may not include fitting"),
            ("src/core/geometry/a.cpp", '#include "model/lfm.glsl"', "geometry may not include model"),
            ("src/core/dataset/a.cpp", '#include "optimize/problem_state.glsl"', "dataset may not include optim"),
            ("src/core/gl/a.cpp", '#include "gather/maps.glsl"', "no text shared with C++"),
            ("src/core/gl/a.cpp", '#include "program.h"', "names no layer"),
            ("src/core/gl/a.cpp", '#include "vulkan/program.h"', "is no layer"),
            ("src/core/dataset/a.cpp", "#include <OpenImageIO/imageio.h>", "only image"),
            ("src/core/fit/a.cpp", "#include <ImfInputFile.h>", "only image"),
            ("src/tools/exchange/a.cpp", "#include <jpeglib.h>", "only image"),
            ("src/tools/publish/a.cpp", "#include <webp/encode.h>", "only image"),
            ("src/tools/capture/a.cpp", "#include <png.h>", "only image"),
            ("src/core/image/a.cpp", '#include "dataset/dataset.h"', "image may not include dataset"),
            ("src/tools/exchange/a.cpp", '#include "capture/image_set.h"', "exchange may not include capture"),
            ("src/tools/cli/a.cpp", "#include <GL/glcorearb.h>", "only gl"),
            ("experiments/a.cpp", "#include <EGL/egl.h>", "only gl"),
            ("src/core/base/config.h", "#include <toml++/toml.h>", "too heavy"),
            ("src/core/dataset/a.h", "#include <nlohmann/json.hpp>", "too heavy"),
            ("src/core/vulkan/a.h", "", "not a layer of this ring"),
            ("src/fits/geometry/a.h", "", "not a layer of this ring"),
            ("src/fits/fitting/a.cpp", '#include "publish/page.h"', "fitting may not include publish"),
            ("src/fits/fitting/a.cpp", '#include "report/csv.h"', "fitting may not include report"),
            ("experiments/a.cpp", '#include "capture/image_set.h"', "experiments may not include capture"),
        ]
        for path, line, expected in cases:
            with self.subTest(path=path, line=line):
                shutil.rmtree(self.root)
                (self.root / "src").mkdir(parents=True)
                self.write(path, "// first\n" + line + "\n")
                errors = self.errors()
                self.assertEqual(len(errors), 1, errors)
                self.assertIn(expected, errors[0])
                if line:
                    self.assertTrue(errors[0].startswith(f"{path}:2: "), errors[0])

    def test_a_class_is_defined_once_where_one_place_sees_it(self):
        self.write("src/core/eval/a.h", "namespace radiafit {\n\nstruct Scene {\n    struct Part {};\n};\n\n}  // namespace radiafit\n")
        self.write("src/core/fit/a.h", "namespace radiafit {\nclass Scene;\nstruct Other {\n    struct Part {};\n};\n}\n"
                                       "namespace radiafit::detail {\nclass Scene {};\n}\n")
        self.assertEqual(self.errors(), [])
        for path, space in (("src/core/fit/b.h", "radiafit"), ("src/tools/stereo/b.h", "radiafit::tools")):
            self.write(path, f"namespace {space} {{\n\n/// Another.\nenum class Scene {{ one }};\n\n}}  // namespace {space}\n")
            self.assertEqual(self.errors(), [f"{path}: defines {space}::Scene, as src/core/eval/a.h does; rename one"])
            (self.root / path).unlink()

    def test_the_map_and_the_build_have_the_same_layers(self):
        rows = [f"| {ring} | `{layer}` | what it is |\n" for ring, layers in check_layers.RINGS.items() for layer in layers]
        sets = [f"set({ring} {' '.join(set(layers) - {'python'})})\n" for ring, layers in check_layers.RINGS.items()]
        self.write("docs/architecture.md", "".join(rows))
        self.write("src/CMakeLists.txt", "".join(sets))
        self.assertEqual(self.errors(), [])
        self.write("docs/architecture.md", "".join(rows[1:]))
        self.write("src/CMakeLists.txt", "".join(sets[1:]))
        self.assertEqual(self.errors(), ["src/CMakeLists.txt: set(core ...) is not RINGS of tests/check_layers.py",
                                         "docs/architecture.md: the map lacks base in core"])

    def test_words_of_the_command_line_are_named_in_libraries(self):
        found = [
            ('throw UserError("choose a smaller --view-side");', "--view-side"),
            ('throw UserError(fmt::format("{}: use -"  // broken\n    "-mu 0", 1\'000));', "--mu"),
            ('log(R"(see "radiafit\n devices" or\n--force)");', "--force"),
            ("log(\"see `radiafit \"\n    \"devices`\");", "radiafit devices"),
            ('log(option_name("--mu"));', "--mu"),
            ('log(at_command_line("judge --split test", "judge --split test"));', "--split"),
        ]
        for line, word in found:
            with self.subTest(line=line):
                self.write("src/core/gl/a.cpp", "// first\n" + line + "\n")
                errors = self.errors()
                self.assertEqual(len(errors), 1, errors)
                self.assertTrue(errors[0].startswith(f"src/core/gl/a.cpp:2: '{word}' "), errors[0])
        for line in ("// --mu of \"--mu\"", "/* '\"' --mu */", 'log("a -- b, c--d, ---e, radiafit fitted");', "int c = '\"'; --c; // \"",
                     'log(option_name("mu"), at_command_line("see `radiafit devices` " "or --mu", "see list()"));'):
            with self.subTest(line=line):
                self.write("src/core/gl/a.cpp", line + "\n")
                self.assertEqual(self.errors(), [])
        self.write("src/tools/cli/a.cpp", 'log("--mu");\n')
        self.assertEqual(self.errors(), [])

    def test_only_the_function_that_puts_a_command_down_is_free(self):
        path, function = "src/tools/capture/import.cpp", 'std::string provenance(const A& a) {\n    return " --gains";\n}\n'
        self.write(path, function)
        self.assertEqual(self.errors(), [])
        self.write(path, function + 'void f() { provenance(" --gains"); }\n')
        self.assertEqual(len(self.errors()), 1)
        self.assertTrue(self.errors()[0].startswith(path + ":4: '--gains'"), self.errors())
        self.write(path, "int x;\n")
        self.assertIn("has no function provenance", self.errors()[0])

    def test_link_lists(self):
        self.write("src/core/base/CMakeLists.txt", "radiafit_layer(base)\n")
        self.write("src/core/geometry/CMakeLists.txt", "# radiafit_gl\nradiafit_layer(geometry LINKS radiafit_base)\n")
        self.assertEqual(self.errors(), [])
        self.write("src/harness/report/CMakeLists.txt", "radiafit_layer(report LINKS radiafit_geometry EXTERNAL radiafit_gl)\n")
        self.assertEqual(self.errors(), ["src/harness/report/CMakeLists.txt: report may not link geometry"])
        self.write("src/harness/report/CMakeLists.txt", "radiafit_layer(report)\n")
        self.write("src/harness/report/a.h", '#include "base/error.h"\n')
        self.assertEqual(self.errors(), ["src/harness/report/CMakeLists.txt: report includes base but doesn't link it"])


@unittest.skipUnless(all(map(shutil.which, check_shaders.TOOLS)), "glslc or glslangValidator is absent")
class Shaders(Tree):
    def errors(self):
        return check_shaders.check(self.root)[0]

    def test_good_texts_pass(self):
        self.write("shaders/a/thing.frag", STAGE + '#include "a/one.glsl"\n#include "a/one.glsl"\nvoid main() { colour = one(); }\n')
        self.write("shaders/a/one.glsl", "vec4 one() { return vec4(1.0); }\n")
        self.write("shaders/model/prelude.glsl", "#define real float\n")
        self.write("shaders/model/m.glsl", "real twice(real x) { return real(2.0) * x; }\n")
        self.assertEqual(self.errors(), [])

    def test_an_error_names_its_own_file_and_line(self):
        self.write("shaders/a/thing.frag", STAGE + '\n#include "a/bad.glsl"\nvoid main() { colour = bad(); }\n')
        self.write("shaders/a/bad.glsl", "// one\n// two\nvec4 bad() { return unknown; }\n")
        self.assertTrue(self.errors()[0].startswith("shaders/a/bad.glsl:3: 'unknown'"), self.errors())
        self.write("shaders/a/bad.glsl", "vec4 bad() { return vec4(1.0); }\n")
        self.write("shaders/a/thing.frag", STAGE + '\n#include "a/bad.glsl"\nvoid main() { colour = bda(); }\n')
        self.assertTrue(self.errors()[0].startswith("shaders/a/thing.frag:5: 'bda'"), self.errors())

    def test_positions_and_places_of_samples_are_the_same_in_every_program(self):
        stage = "#version 450 core\n{}void main() {{ gl_Position = vec4(0.0); }}\n"
        self.write("shaders/a/thing.vert", stage.format(""))
        self.assertEqual(self.errors(), ["shaders/a/thing.vert: gl_Position must be invariant"])
        self.write("shaders/a/thing.vert", stage.format("invariant gl_Position;\n"))
        self.assertEqual(self.errors(), [])
        row = "float camera_row(vec4 row, vec3 p) {{ {}float sum = {} + row.w; return sum; }}\n"
        self.write("shaders/a/thing.frag", STAGE + '#include "distribute/camera_row.glsl"\nvoid main() { colour = vec4(camera_row(vec4(1.0), vec3(1.0))); }\n')
        self.write("shaders/distribute/camera_row.glsl", row.format("", "dot(row.xyz, p)"))
        self.assertEqual(self.errors(), ["shaders/distribute/camera_row.glsl: sum must be precise",
                                         "shaders/distribute/camera_row.glsl: write the sum out, in place of dot()"])
        self.write("shaders/distribute/camera_row.glsl", row.format("precise ", "row.x * p.x + row.y * p.y + row.z * p.z"))
        self.assertEqual(self.errors(), [])

    def test_what_compilers_get_wrong_is_not_written(self):
        for line, name in (("bool some[3];", "bool some["), ("bool[3] some = bool[3](true, true, true);", "bool[3]"),
                           ("bool b = isnan(1.0);", "isnan(")):
            self.write("shaders/a/thing.frag", STAGE + f"void main() {{ {line} colour = vec4(1.0); }}\n")
            self.assertTrue(self.errors()[0].startswith(f"shaders/a/thing.frag: {name}: "), self.errors())

    def test_a_uniform_needs_no_location(self):
        self.write("shaders/a/thing.frag", STAGE + "uniform float x;\nvoid main() { colour = vec4(x); }\n")
        self.assertEqual(self.errors(), [])

    def test_variants_are_found_or_declared(self):
        body = "void main() {\n    colour = vec4(0.0);\n#ifdef FLAG\n    colour = broken;\n#endif\n}\n"
        self.write("shaders/a/thing.frag", STAGE + body)
        self.assertIn("[a/thing.frag FLAG]", self.errors()[0])
        self.write("shaders/a/thing.frag", STAGE + "// variants: OTHER=1,2\n" + body)
        self.assertEqual(self.errors(), [])
        self.write("shaders/a/thing.frag", STAGE + "// variants: OTHER=1,2 FLAG=-,1\n" + body)
        self.assertIn("[a/thing.frag OTHER=2 FLAG=1]", " ".join(self.errors()))
        for condition in ("#if KIND == 3", "#if KIND > 2", "#if KIND >= 3"):
            self.write("shaders/a/thing.frag", STAGE + "#ifndef KIND\n#define KIND 0\n#endif\n" + body.replace("#ifdef FLAG", condition))
            self.assertIn("[a/thing.frag KIND=3]", self.errors()[0])

    def test_a_definition_names_an_included_file(self):
        stage = STAGE + '// variants: MODEL=*\n#include "model/MODEL.glsl"\nvoid main() { colour = vec4(one()); }\n'
        self.write("shaders/a/thing.frag", stage)
        self.write("shaders/model/prelude.glsl", "#define real float\n")
        self.write("shaders/model/a.glsl", "#define BASIS_COUNT 1\nfloat sample_terms() { return 1.0; }\nfloat one() { return sample_terms(); }\n")
        self.assertEqual(self.errors(), [])
        self.write("shaders/model/b.glsl", "#define BASIS_COUNT 1\nfloat sample_terms() { return 1.0; }\n")
        self.assertIn("[a/thing.frag MODEL=b]", self.errors()[0])
        # No stage takes a model without sample_terms; its text is compiled on its own, with one and two lobes.
        self.write("shaders/model/b.glsl", "#define BASIS_COUNT 1\n#if LOBE_COUNT == 2\nfloat two() { return broken; }\n#endif\n")
        self.assertIn("[model/b.glsl in an empty stage #define LOBE_COUNT 2]", self.errors()[0])

    def test_nothing_goes_uncompiled(self):
        self.write("shaders/a/alone.glsl", "float x;\n")
        self.assertIn("no stage includes it", self.errors()[0])
        self.write("shaders/a/alone.glsl", "")
        self.write("shaders/a/odd.txt", "")
        self.assertIn("the name ends in none", " ".join(self.errors()))

    def test_shared_texts_missing_files_and_versions(self):
        self.write("shaders/model/prelude.glsl", "#define real float\n")
        self.write("shaders/model/m.glsl", "\nreal broken(real x) { return y; }\n")
        self.assertTrue(self.errors()[0].startswith("shaders/model/m.glsl:2: 'y'"), self.errors())
        self.write("shaders/model/m.glsl", "")
        self.write("shaders/a/thing.frag", STAGE + '#include "none.glsl"\nvoid main() {}\n')
        self.assertEqual(self.errors(), ["shaders/none.glsl: no such file"])
        self.write("shaders/a/thing.frag", STAGE + "#include none\nvoid main() {}\n")
        self.assertEqual(self.errors(), ["shaders/a/thing.frag:3: #include needs a file in quotes"])
        self.write("shaders/a/thing.frag", "void main() {}\n")
        self.assertEqual(self.errors(), ["shaders/a/thing.frag:1: a stage begins with #version"])


@unittest.skipUnless(all(map(shutil.which, check_costs.TOOLS)), "a SPIR-V tool is absent")
class Costs(Tree):
    def errors(self):
        return check_costs.check(self.root)[0]

    def declare(self, *rows):
        self.write("src/core/fragment/pass_costs.cpp", "".join(f"    {row},\n" for row in rows))

    def counted(self, body, before=""):
        """What the check says that a stage costs, of which nothing is declared rightly."""
        text = (STAGE + "layout(location = 1) uniform vec4 x;\nlayout(location = 2) uniform vec4 y;\n" +
                "layout(location = 3) uniform int n;\nlayout(binding = 0) uniform sampler2D source;\n" +
                "layout(binding = 1) uniform usampler2D drawn;\n" + before + "void main() {\n" + body + "\n}\n")
        self.write("shaders/a/thing.frag", text)
        self.declare('{"a/thing.frag", "", 99, {0, 0, 0}, {}}')
        errors = self.errors()
        self.assertEqual(len(errors), 1, errors)
        return errors[0].rsplit('"", ', 1)[-1].rstrip("},")

    def test_counts_known_by_hand(self):
        fetch = "texelFetch(source, ivec2(gl_FragCoord.xy), 0)"  # two conversions
        for body, expected in [
            ("colour = x * y;", "1, {4, 0, 0}, {"),
            ("colour = x * y + 1.0;", "1, {8, 0, 0}, {"),
            ("colour = vec4(x.yzw, 1.0);", "1, {0, 0, 0}, {"),
            ("colour = vec4(dot(x.xyz, y.xyz));", "1, {5, 0, 0}, {"),
            ("colour = vec4(sqrt(x.x) / exp(y.x));", "1, {3, 0, 0}, {"),
            ("colour = vec4(normalize(x.xyz), length(y.xyz));", "1, {15, 0, 0}, {"),
            ("colour = vec4(cross(x.xyz, y.xyz), clamp(x.x, y.x, y.y));", "1, {11, 0, 0}, {"),
            (f"colour = {fetch};", "1, {2, 1, 16}, {"),
            (f"colour = {fetch} + {fetch};", "1, {6, 1, 16}, {"),
            ("colour = vec4(texelFetch(drawn, ivec2(0), 0));", "1, {4, 1, 4}, {"),
            ("vec4 s = x; for (int i = 0; i < 3; ++i) s *= y; colour = s;", "1, {12, 0, 0}, {"),
            # two of the counter, four of the sum, and one fetch that converts nothing
            ("vec4 s = x; for (int i = 0; i < n; ++i) s += texelFetch(source, ivec2(i), 0); colour = s;",
             "1, {0, 0, 0}, {6, 1, 16"),
            # the outer counter is left out
            ("vec4 s = x; for (int j = 0; j < n; ++j) for (int i = 0; i < n; ++i) s += y; colour = s;",
             "1, {0, 0, 0}, {6, 0, 0"),
        ]:
            with self.subTest(body=body):
                self.assertEqual(self.counted(body), expected)
        self.assertEqual(self.counted("colour = x; more[0] = more[1] = y;", "layout(location = 1) out vec4 more[2];\n"),
                         "3, {0, 0, 0}, {")

    def test_a_changed_shader_and_an_undeclared_one_are_named(self):
        self.write("shaders/a/thing.frag", STAGE + "void main() { colour = gl_FragCoord * gl_FragCoord; }\n")
        self.declare('{"a/thing.frag", "", 1, {4, 0, 0}, {}}')
        self.assertEqual(self.errors(), [])
        self.write("shaders/a/thing.frag", STAGE + "void main() { colour = gl_FragCoord * gl_FragCoord * 2.0; }\n")
        self.assertIn('has    {"a/thing.frag", "", 1, {8, 0, 0}, {}}', self.errors()[0])
        self.assertEqual(check_costs.check(self.root, write=True), ([], 1))
        self.assertEqual(self.errors(), [])
        self.write("shaders/a/other.frag", STAGE + "void main() { colour = vec4(0.0); }\n")
        self.assertIn("shaders/a/other.frag: src/core/fragment/pass_costs.cpp declares no cost of it", " ".join(self.errors()))

    def test_what_a_variant_leaves_open_must_not_matter(self):
        self.write("shaders/a/thing.frag", STAGE + "void main() { colour = vec4(SIDE == 8 ? 1.0 : gl_FragCoord.x * 3.0); }\n")
        self.declare('{"a/thing.frag", "", 1, {0, 0, 0}, {}}')
        self.assertIn("depending on what the variant leaves open", self.errors()[0])

    def test_work_between_two_loops_has_no_place(self):
        self.write("shaders/a/thing.frag", STAGE + "layout(location = 1) uniform ivec2 n;\n" +
                   "layout(binding = 0) uniform sampler2D source;\nvoid main() {\n    colour = vec4(0.0);\n"
                   "    for (int j = 0; j < n.x; ++j) {\n        colour += texelFetch(source, ivec2(j), 0);\n"
                   "        for (int i = 0; i < n.y; ++i) colour *= colour;\n    }\n}\n")
        self.declare('{"a/thing.frag", "", 1, {0, 0, 0}, {}}')
        self.assertIn("work between two loops", self.errors()[0])


@unittest.skipUnless(shutil.which("clang-format"), "clang-format is absent")
class Format(Tree):
    def test_an_unformatted_file_fails(self):
        here = pathlib.Path(__file__).resolve().parent
        (self.root / "tests").mkdir()
        shutil.copy(here / "check_format", self.root / "tests")
        shutil.copy(here.parent / ".clang-format", self.root)
        (self.root / "experiments").mkdir()
        for text, status in (("int x = 1;\n", 0), ("int   x=1;\n", 1)):
            self.write("src/a.cpp", text)
            result = subprocess.run([str(self.root / "tests" / "check_format")], capture_output=True, text=True)
            self.assertEqual(result.returncode, status, result.stderr)


if __name__ == "__main__":
    unittest.main()
