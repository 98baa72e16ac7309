"""What drivers are free to compute otherwise than it is written, or are known to compute badly.

A rule is a function from a Shader to (line of the preprocessed source, what stands there); RULES has them with one line
on why. What a rule cannot know, a comment says: `lint NAME: why`, on the line of the finding or the one above.
"""
import math
import re

from shader_tree import Node

# Built-in functions that are sums of products within.
FUSED_INSIDE = {
    "dot-product", "matrix-times-vector", "vector-times-matrix", "matrix-multiply", "matrix-times-matrix", "length",
    "distance", "normalize", "cross-product", "mix", "reflect", "refract", "face-forward", "determinant", "inverse",
    "smoothstep", "fma", "mod", "matrix mult second child into first child",
    "vector-times-matrix second child into first child"}
MULTIPLY = {"component-wise multiply", "vector-scale", "matrix-scale", "multiply second child into first child",
            "vector scale second child into first child"}
ADD = {"add", "subtract", "add second child into first child", "subtract second child into first child"}
ARITHMETIC = MULTIPLY | ADD | {"divide", "Negate value", "divide second child into first child"}
# What gives on values as they are.
PASSING = {"direct index", "indirect index", "vector swizzle", "Sequence", "Test condition and select", "true case",
           "false case", "Comma"}
MOVES = {"move second child to first child"} | {op for op in ARITHMETIC | FUSED_INSIDE if "into first child" in op}
FULL_TURNS = 100.0  # rad: some 16 turns, where the H200's sine is off by 1e-5


def call_of(node):
    return node.text.removeprefix("Function Call: ") if node.text.startswith("Function Call: ") else None


def is_value(node):
    """Hands values of its children on, as arithmetic does and comparisons or calls do not."""
    return (node.text in ARITHMETIC | PASSING or node.text.startswith(("Construct ", "Convert "))
            or "direct index for structure" in node.text)


def values_below(node):
    """The nodes whose values make up that of `node`, itself included."""
    yield node
    if is_value(node):
        # Of an index and of a condition the value goes nowhere.
        children = node.children[:1] if "index" in node.text else node.children
        for child in children:
            if child.text != "Condition":
                yield from values_below(child)


def name_of(node):
    """Of the variable that an expression stores to or reads."""
    while node.children and ("index" in node.text or node.text == "vector swizzle"):
        node = node.children[0]
    return node.text if node.text.startswith("'") else None


def products_in(function):
    """Names of variables that some statement sets to a product, which need not be exact then."""
    return {name_of(move.children[0]) for move in function.walk()
            if move.text in MOVES and any(v.text in MULTIPLY and not v.precise for v in values_below(move.children[1]))}


def fuses(function, functions, seen=()):
    """Whether a driver may fuse a product and a sum of what the function gives back."""
    if re.match(r"global (void|bool|highp u?int|u?int)\b", function.type) and "out" not in str(
            [p.type for p in function.children[0].children]):
        return False
    products = products_in(function)
    for node in function.walk():
        callee = call_of(node)
        if callee in functions and callee not in seen and fuses(functions[callee], functions, (*seen, callee)):
            return True
        if node.text in FUSED_INSIDE and node.is_float:
            return True
        if node.text in ADD and node.is_float and not node.precise and any(
                child.text in MULTIPLY or name_of(child) in products for child in node.children):
            return True
    return False


def precise_values(function):
    """Expressions that the value of something precise is computed from."""
    for node in function.walk():
        if node.text in MOVES and node.children[0].precise:
            yield node.children[1]
            if node.text in FUSED_INSIDE:
                yield node
        elif node.text in ARITHMETIC and node.precise:
            yield node


def precise_calls(shader):
    for function in shader.functions.values():
        for root in precise_values(function):
            for node in values_below(root):
                callee = call_of(node)
                if node.text in FUSED_INSIDE and node.is_float:
                    yield node.line, f"{node.text} within a precise expression"
                elif callee in shader.functions and fuses(shader.functions[callee], shader.functions):
                    yield node.line, f"{callee.split('(')[0]}(), not precise itself, within a precise expression"
        yield from precise_results(shader, function)


def precise_results(shader, function):
    """Precise variables that a call fills in."""
    for node in function.walk():
        callee = shader.functions.get(call_of(node))
        if callee is None:
            continue
        for parameter, argument in zip(callee.children[0].children, node.children):
            if "out " in parameter.type and argument.precise and fuses(callee, shader.functions):
                yield node.line, f"{call_of(node).split('(')[0]}(), not precise itself, fills in something precise"


def same_twice(node):
    return len(node.children) == 2 and node.children[0].is_float and node.children[0].same_as(node.children[1])


def nan_tests(shader):
    for function in shader.functions.values():
        for node in function.walk():
            if node.text in ("Compare Not Equal", "Compare Equal", "Equal", "NotEqual", "not equal", "equal") and same_twice(node):
                yield node.line, "a number compared with itself"
            elif node.text in ("subtract", "divide") and same_twice(node):
                yield node.line, "a number less or over itself"
            elif node.text in ("isnan", "isinf") and node.children[0].text in ARITHMETIC:
                yield node.line, f"{node.text} of arithmetic, which is folded first"


class Magnitude:
    """A bound of |value| as far as an expression shows one. A number that nothing bounds counts as 1, the size of most:
    this finds angles that are plainly large, not all that may be."""

    def __init__(self, function):
        self.stores = {}
        for node in function.walk():
            if node.text in MOVES:
                self.stores.setdefault(name_of(node.children[0]), []).append(node.children[1])
        self.seen = set()

    def of(self, node):
        text, children = node.text, node.children
        if text == "Constant:":
            return max(self.of(child) for child in children)
        if re.fullmatch(r"-?[\d.]+(e[-+]?\d+)?|[-+]?1\.#INF|inf", text):
            return abs(float(text.replace("1.#", "")))
        if text in MULTIPLY:
            return math.prod(self.of(child) for child in children)
        if text in ADD:
            return sum(self.of(child) for child in children)
        if text == "divide":
            divisor = children[1]
            return self.of(children[0]) / (max(self.of(divisor), 1e-6) if divisor.text == "Constant:" else 1.0)
        if text in ("min", "max", "clamp"):
            sizes = [self.of(child) for child in children]
            return min(sizes) if text == "min" else sizes[-1] if text == "clamp" else max(sizes)
        if text in ("arc tangent", "arc cosine", "arc sine"):
            return math.pi
        if text in ("Convert uint to float", "Convert int to float"):
            inner = children[0]
            return self.of(inner) if inner.text in ("Constant:", "mod", "right-shift") else 2.0**31
        if text in ("Negate value", "Absolute value", "Floor", "Ceiling", "vector swizzle") or "index" in text:
            return self.of(children[0])
        if text.startswith("Construct"):
            return max(map(self.of, children), default=1.0)
        if text in self.stores and text not in self.seen:
            self.seen.add(text)
            size = max(map(self.of, self.stores[text]))
            self.seen.discard(text)
            return size
        return 1.0


def many_turns(shader):
    for function in shader.functions.values():
        magnitude = None
        for node in function.walk():
            if node.text in ("sine", "cosine", "tangent") and node.children:
                magnitude = magnitude or Magnitude(function)
                size = magnitude.of(node.children[0])
                if size > FULL_TURNS:
                    yield node.line, f"{node.text} of an angle of up to {size:.3g} rad"


NUMBER = re.compile(r"(?<![\w.])((?:\d+\.\d*|\.\d+|\d+(?=[eE]))(?:[eE][-+]?\d+)?)[fF]?(?!\w)")
SMALLEST_NORMAL, LARGEST_DIVISOR = 2.0**-126, 2.0**126


def extreme_numbers(shader):
    for number, line in enumerate(shader.source, 1):
        for match in NUMBER.finditer(line):
            value, before = float(match[1]), line[:match.start()].rstrip()
            if 0.0 < value < SMALLEST_NORMAL:
                yield number, f"{match[0]} is denormal"
            elif value > LARGEST_DIVISOR and before.endswith("/"):
                yield number, f"the reciprocal of {match[0]} is denormal"
            elif value > LARGEST_DIVISOR and re.search(r"/\s*(min|max|clamp)\([^()]*$", before):
                yield number, f"a divisor of up to {match[0]}, whose reciprocal is denormal"


def is_positive(node):
    """Plainly above 0."""
    if node.text == "Constant:":
        return all(float(child.text) > 0.0 for child in node.children)
    if node.text in ("max", "clamp"):
        return any(is_positive(child) for child in node.children[1:2])
    return node.text in ("add", "component-wise multiply", "exp", "exp2") and all(map(is_positive, node.children))


def zero_powers(shader):
    for function in shader.functions.values():
        for node in function.walk():
            if node.text == "pow" and len(node.children) == 2:
                base, exponent = node.children
                if not (is_positive(base) or is_positive(exponent)):
                    yield node.line, "pow whose base and exponent may both be 0"


def named_functions(*names):
    def rule(shader):
        for function in shader.functions.values():
            for node in function.walk():
                if node.text in names and node.children:
                    yield node.line, node.text
    return rule


RULES = {
    "precise": (precise_calls, "a GPU's compiler fuses a*b + c inside of dot(), matrices and plain functions even where "
                               "the result is precise (H200): write the sum out, or make the function precise"),
    "nan": (nan_tests, "x/x, x - x and isnan(x - x) fold to constants (H200), NaN * 0.0 is 0 (lavapipe): use isnan(x), or "
                       "compare bits"),
    "turns": (many_turns, "sine and cosine are off by 1.4e-4 at 1,000 rad (H200): reduce the angle first"),
    "extreme": (extreme_numbers, "denormals are flushed to 0, and so is 1/x above 2^126 (H200)"),
    "pow": (zero_powers, "pow(0, 0) is NaN (H200)"),
    "arc": (named_functions("arc cosine", "arc sine"), "acos is off by 1.6e-4, asin by 3.9e-4 (lavapipe): atan(y, x) has "
                                                       "all digits"),
    "fma": (named_functions("fma"), "lavapipe rounds fma twice"),
}


def findings(shader):
    """(rule, (file, line), what), once each."""
    seen = {}
    for name, (rule, _) in RULES.items():
        for line, what in rule(shader):
            place = shader.places[line - 1] if line else ("", 0)
            seen.setdefault((name, place, what))
    return list(seen)
