"""The rules. Each takes what it looks at and gives one line, "place: what is wrong", per violation."""
import re
import subprocess

import sources

MOST_LINES = 400
MOST_FUNCTION_LINES = 60
MOST_SUBJECT = 72
# A file above MOST_LINES says in its first ten lines why it is still one concept.
REASON = re.compile(r"Long because\b")
TEXT = sources.CPP | sources.GLSL | {".py", ".sh", ".md", ".txt", ".js", ".html", ".sql"}


def white_space(path, text):
    for number, line in enumerate(text.split("\n"), 1):
        if "\t" in line and path.suffix in sources.CPP | sources.GLSL | {".py"}:
            yield f"{path}:{number}: a tab"
        if line != line.rstrip():
            yield f"{path}:{number}: white space at the end of the line"
    if text and not text.endswith("\n"):
        yield f"{path}: no newline at the end of the file"


def length(path, text, most=MOST_LINES):
    """No source file above `most` lines without a stated reason."""
    lines = text.split("\n")
    if len(lines) - 1 > most and not any(REASON.search(line) for line in lines[:10]):
        yield (f"{path}: {len(lines) - 1} lines, more than {most}; split it by concept, "
               "or say 'Long because …' in its first ten lines")


def functions(root, paths):
    """(path, line, name, lines) of each function that has a body, by universal-ctags."""
    command = ["ctags", "--languages=C++", "--langmap=C++:.cpp.h.glsl.comp.vert.frag", "--kinds-C++=f",
               "--fields=+ne", "--sort=no", "-L", "-", "-f", "-"]
    listing = "\n".join(str(path) for path in paths)
    tags = subprocess.run(command, input=listing, cwd=root, check=True, capture_output=True, text=True).stdout
    for tag in tags.splitlines():
        fields = tag.split("\t")
        numbers = dict(field.split(":", 1) for field in fields[3:] if re.match(r"(line|end):\d+$", field))
        if "end" in numbers:
            first, last = int(numbers["line"]), int(numbers["end"])
            yield fields[1], first, fields[0], last - first + 1


def function_length(found, exceptions):
    for path, line, name, lines in found:
        most = exceptions.get(f"{path} {name}", MOST_FUNCTION_LINES)
        if lines > most:
            yield f"{path}:{line}: {name} has {lines} lines, more than {most}"


def outlived(exceptions, found, most):
    """Exceptions for what is within `most` by now, or gone. `found`: (place, lines)."""
    longest = {}
    for place, lines in found:
        longest[place] = max(lines, longest.get(place, 0))
    for place in exceptions:
        if longest.get(place, 0) <= most:
            yield f"{place} needs no exception any more: take it out of exceptions.json"


INCLUDE = re.compile(r'^#include "((?:shared|server|worker|shaders)/[^"]+)"', re.MULTILINE)


def owners_of(found):
    """Which libraries a folder holds, and which library or program compiles a source."""
    by_folder, by_source = {}, {}
    for library in found.values():
        if not library.program:
            by_folder.setdefault(str(library.folder), []).append(library)
        for source in library.sources:
            by_source[str(library.folder / source)] = library
    return by_folder, by_source


def owning(path, by_folder, by_source):
    """A header belongs to the library that compiles the source beside it, else to all of its folder."""
    compiled = by_source.get(str(path.with_suffix(".cpp")))
    return [compiled] if compiled else by_folder.get(str(path.parent), [])


def used_outside(texts):
    """The headers that a file of another folder includes."""
    return {target for path, text in texts.items() for target in INCLUDE.findall(text)
            if target.rsplit("/", 1)[0] != str(path.parent)}


def include(path, text, found, public_headers):
    """A file includes what its library links: a header that other folders include in public, the rest also in private."""
    by_folder, by_source = owners_of(found)
    own = owning(path, by_folder, by_source)
    if not own:
        return
    linked = {library.name for library in own}
    for library in own:
        linked |= sources.reached(found, [library.name])
        if str(path) not in public_headers:
            linked |= sources.reached(found, library.private_links)
    for match in INCLUDE.finditer(text):
        wanted = {library.name for library in owning(path.__class__(match.group(1)), by_folder, by_source)}
        if wanted and not wanted & linked:
            number = text.count("\n", 0, match.start()) + 1
            yield (f"{path}:{number}: includes {match.group(1)}, but {own[0].name} does not link "
                   f"{' or '.join(sorted(wanted))}")


def sides(path, text):
    """shared knows neither server nor worker; these two never include each other; Vulkan stays in worker/vk."""
    side = path.parts[0]
    forbidden = {"shared": ("server/", "worker/"), "server": ("worker/",), "worker": ("server/",)}.get(side, ())
    for number, line in enumerate(text.split("\n"), 1):
        match = re.match(r'#include [<"]([^>"]+)[>"]', line)
        if not match:
            continue
        if match.group(1).startswith(forbidden or ("\0",)):
            yield f"{path}:{number}: {side} must not include {match.group(1)}"
        if match.group(1).startswith("vulkan/") and path.parts[:2] != ("worker", "vk"):
            yield f"{path}:{number}: Vulkan headers stay in worker/vk"


def subject(commit, line):
    if len(line) > MOST_SUBJECT:
        yield f"commit {commit}: its subject has {len(line)} characters, more than {MOST_SUBJECT}: {line}"


# Of a namespace or a class; what stands further in is a statement.
DECLARATION = re.compile(r"^ {0,4}(?:\[\[nodiscard\]\] )?\w[\w:<>,*& ]*[ *&](\w+)\([^;{}]*\)(?: const)?(?: noexcept)?;", re.MULTILINE)


def unused_declarations(headers, words):
    """Functions that a header declares and nothing calls. `words`: how often each identifier stands in C++, GLSL and
    CMake."""
    for path, text in headers:
        for match in DECLARATION.finditer(text):
            # Once declared and once defined is never called.
            if words.get(match.group(1), 0) <= 2:
                number = text.count("\n", 0, match.start(1)) + 1
                yield f"{path}:{number}: {match.group(1)} is declared, and called nowhere"
