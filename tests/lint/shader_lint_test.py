"""What each rule finds and what it lets pass, on small shaders."""
import shutil
import tempfile
import unittest
from pathlib import Path

from shader_lint import ROOT, lint, write_tables

HEAD = """#version 460
layout(local_size_x = 1) in;
layout(std430, binding = 0) buffer Values { float v[]; };
layout(std430, binding = 1) buffer Counts { uint n[]; };
"""


class Rules(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def found(self, body, functions=""):
        """Rules and lines, counted from the first of the body, of what is found."""
        head = HEAD + functions + "void main() {\n    vec3 a = vec3(v[0], v[1], v[2]), b = vec3(v[3]);\n    float x = v[4];\n"
        file = self.folder / "snippet.comp"
        file.write_text(head + body + "\n}\n")
        return [(rule, line - head.count("\n")) for _, line, rule, _ in lint([file], [self.folder])]

    def assert_finds(self, rule, body, functions=""):
        self.assertEqual({name for name, _ in self.found(body, functions)}, {rule}, body)

    def assert_passes(self, body, functions=""):
        self.assertEqual(self.found(body, functions), [], body)


class Precise(Rules):
    PLAIN = "float plain(float p, float q) { return p * q + 1.0; }\n"
    EXACT = "float exact(float p, float q) { precise float r = p * q + 1.0; return r; }\n"

    def test_dot_in_a_precise_sum(self):
        self.assert_finds("precise", "precise float s = dot(a, b) + x; n[0] = floatBitsToUint(s);")

    def test_dot_alone(self):
        self.assert_finds("precise", "precise float s = dot(a, b); n[0] = floatBitsToUint(s);")

    def test_dot_by_way_of_another_variable(self):
        self.assertEqual(self.found("float d = dot(a, b);\nprecise float s = d + x;\nn[0] = floatBitsToUint(s);"),
                         [("precise", 1)])

    def test_matrices(self):
        for product in ("m * a", "a * m", "(m * m)[0]"):
            self.assert_finds("precise", f"mat3 m = mat3(x); precise vec3 s = {product}; n[0] = floatBitsToUint(s.x);")

    def test_other_functions_that_sum_products(self):
        for call in ("length(a)", "distance(a, b)", "normalize(a).x", "cross(a, b).x", "mix(x, v[5], v[6])",
                     "reflect(a, b).x"):
            self.assert_finds("precise", f"precise float s = {call}; n[0] = floatBitsToUint(s);")

    def test_a_plain_function(self):
        self.assert_finds("precise", "precise float s = plain(x, v[5]); n[0] = floatBitsToUint(s);", self.PLAIN)

    def test_a_plain_function_within_another(self):
        outer = self.PLAIN + "float outer(float p) { return plain(p, p); }\n"
        self.assert_finds("precise", "precise float s = 2.0 * outer(x); n[0] = floatBitsToUint(s);", outer)

    def test_a_plain_function_that_goes_by_a_variable(self):
        stepwise = "float stepwise(float p, float q) { float r = p * q; return r + 1.0; }\n"
        self.assert_finds("precise", "precise float s = stepwise(x, v[5]); n[0] = floatBitsToUint(s);", stepwise)

    def test_a_plain_function_that_fills_in_a_precise_variable(self):
        fill = "void fill(float p, out float q) { q = p * p + 1.0; }\n"
        self.assert_finds("precise", "precise float s; fill(x, s); s = s + x; n[0] = floatBitsToUint(s);", fill)

    def test_a_precise_function_passes(self):
        self.assert_passes("precise float s = exact(x, v[5]) + x; n[0] = floatBitsToUint(s);", self.EXACT)

    def test_a_product_without_a_sum_passes(self):
        self.assert_passes("precise float s = scaled(x) + x; n[0] = floatBitsToUint(s);",
                           "float scaled(float p) { return 2.0 * p; }\n")

    def test_a_sum_written_out_passes(self):
        self.assert_passes("precise float s = a.x * b.x + a.y * b.y; n[0] = floatBitsToUint(s);")

    def test_what_is_not_precise_passes(self):
        self.assert_passes("float s = dot(a, b) + x; n[0] = floatBitsToUint(s);")

    def test_what_a_precise_value_goes_into_passes(self):
        self.assert_passes("precise vec3 s = a + b; n[0] = floatBitsToUint(dot(s, s));")

    def test_arguments_pass(self):
        self.assert_passes("precise float s = exact(dot(a, b), x) + x; n[0] = floatBitsToUint(s);", self.EXACT)


class NanTests(Rules):
    def test_a_number_against_itself(self):
        for test in ("x != x", "x == x", "!(x == x)", "v[0] != v[0]"):
            self.assert_finds("nan", f"if ({test}) n[0] = 1u;")

    def test_isnan_of_arithmetic(self):
        for test in ("isnan(x - v[5])", "isnan(0.0 * x)", "isinf(x + x)"):
            self.assert_finds("nan", f"if ({test}) n[0] = 1u;")

    def test_a_number_less_or_over_itself(self):
        for value in ("x - x", "x / x", "v[1] - v[1]"):
            self.assert_finds("nan", f"v[0] = {value};")

    def test_isnan_of_a_value_passes(self):
        self.assert_passes("if (isnan(x) || isinf(v[5]) || x != v[5] || n[1] == n[1]) n[0] = 1u;")


class Turns(Rules):
    def test_many_turns(self):
        for angle in ("1000.0 * x", "6.2831853 * x * 100.0", "float(n[0]) * 2.4", "2.4 * float(n[0] / 3u) + x"):
            self.assert_finds("turns", f"v[0] = sin({angle});")

    def test_by_way_of_a_variable(self):
        self.assert_finds("turns", "float phi = 2.4 * float(n[0]); v[0] = cos(phi);")

    def test_few_turns_pass(self):
        self.assert_passes("float phi = 6.2831853 * x; v[0] = sin(phi) + cos(3.0 * phi) + cos(2.0 * atan(x, v[5]));")


class ExtremeNumbers(Rules):
    def test_denormals_and_their_reciprocals(self):
        for value in ("1e-39", "max(x, 1.0e-40)", "1.0 / 1e38", "1.0 / min(x, 2e38)"):
            self.assert_finds("extreme", f"v[0] = {value};")

    def test_normal_numbers_pass(self):
        self.assert_passes("v[0] = max(x, 1e-37) / 1e37 + min(x, 1e38); n[0] = 0xffffu;")


class Powers(Rules):
    def test_of_what_may_be_zero(self):
        self.assert_finds("pow", "v[0] = pow(max(x, 0.0), v[5]);")

    def test_with_a_positive_base_or_exponent_pass(self):
        self.assert_passes("v[0] = pow(x, 2.4) + pow(max(x, 0.1), v[5]) + pow(2.0, x);")


class Functions(Rules):
    def test_arcs(self):
        self.assert_finds("arc", "v[0] = acos(x);")
        self.assert_finds("arc", "v[0] = asin(x);")
        self.assert_passes("v[0] = atan(x, v[5]);")

    def test_fma(self):
        self.assert_finds("fma", "v[0] = fma(x, x, v[5]);")


class Comments(Rules):
    def test_a_reason_excuses_its_own_rule_on_this_line_or_the_next(self):
        self.assert_passes("v[0] = acos(x);  // lint arc: for a test")
        self.assert_passes("// lint arc: for a test\nv[0] = acos(x);")
        self.assertEqual(self.found("// lint arc: for a test\n\nv[0] = acos(x);"), [("arc", 3)])
        self.assertEqual(self.found("v[0] = acos(x);  // lint pow: for a test"), [("arc", 1)])

    def test_without_a_reason_nothing_is_excused(self):
        self.assertEqual(self.found("v[0] = acos(x);  // lint arc:"), [("arc", 1)])


class Places(Rules):
    def test_are_those_of_the_included_file(self):
        (self.folder / "part.glsl").write_text("\n\nfloat part(float y) { return acos(y); }\n")
        file = self.folder / "whole.comp"
        file.write_text(HEAD.replace("460\n", "460\n#extension GL_GOOGLE_include_directive : require\n", 1) +
                        '#include "part.glsl"\nvoid main() { v[0] = part(v[1]); }\n')
        [(name, line, rule, _)] = lint([file], [self.folder])
        self.assertEqual((Path(name).name, line, rule), ("part.glsl", 3, "arc"))


class Kernels(Rules):
    def test_a_fault_planted_in_one_is_found(self):
        shaders = self.folder / "shaders"
        shutil.copytree(ROOT / "shaders", shaders)
        part = shaders / "shapes" / "round.glsl"
        text = part.read_text()
        self.assertIn("-preciseDot(f, d)", text)
        part.write_text(text.replace("-preciseDot(f, d)", "-dot(f, d)"))
        tables = self.folder / "tables"
        write_tables(tables)
        [(name, line, rule, _)] = lint([shaders / "trace_rays.comp"], [shaders, tables])
        self.assertEqual((Path(name).name, rule), ("round.glsl", "precise"))
        self.assertIn("-dot(f, d)", part.read_text().splitlines()[line - 1])

    def test_one_that_does_not_compile_is_no_clean_one(self):
        with self.assertRaisesRegex(RuntimeError, "ERROR.*undeclared"):
            self.found("v[0] = nothing;")


if __name__ == "__main__":
    unittest.main()
