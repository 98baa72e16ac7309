"""What the rules read: the tracked files of the repository, and the link graph of its CMake libraries."""
import pathlib
import re
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
CPP = {".cpp", ".h"}
GLSL = {".glsl", ".comp", ".vert", ".frag"}
PRODUCT = ("shared", "server", "worker", "shaders")


def tracked(root=ROOT):
    """Paths relative to the root, without generated and binary files."""
    names = subprocess.run(["git", "-C", root, "ls-files", "-z"], check=True, capture_output=True).stdout
    return [pathlib.PurePosixPath(name) for name in names.decode().split("\0") if name and (root / name).is_file()]


class Library:
    """A tilefarm_library(), or an add_executable(): its folder, and what it links in public and in private."""

    def __init__(self, name, folder, sources, links, private_links, program=False):
        self.name, self.folder, self.sources = name, folder, sources
        self.links, self.private_links, self.program = links, private_links, program


CALL = re.compile(r"^\s*tilefarm_library\((\w+)([^)]*)\)", re.MULTILINE)
PROGRAM = re.compile(r"^\s*add_executable\(([\w-]+)([^)]*)\)", re.MULTILINE)
PROGRAM_LINKS = re.compile(r"^\s*target_link_libraries\(([\w-]+) PRIVATE([^)]*)\)", re.MULTILINE)
KEYWORDS = {"SOURCES", "LINKS", "PRIVATE_LINKS"}


def libraries_in(folder, text):
    """The libraries and programs that one CMakeLists.txt defines."""
    text = re.sub(r"#.*", "", text)
    links = {name: arguments.split() for name, arguments in PROGRAM_LINKS.findall(text)}
    for name, arguments in PROGRAM.findall(text):
        yield Library(name, folder, arguments.split(), [], links.get(name, []), program=True)
    for name, arguments in CALL.findall(text):
        lists, current = {keyword: [] for keyword in KEYWORDS}, None
        for word in arguments.split():
            if word in KEYWORDS:
                current = lists[word]
            elif current is not None:
                current.append(word)
        yield Library(name, folder, lists["SOURCES"], lists["LINKS"], lists["PRIVATE_LINKS"])


def libraries(root=ROOT):
    found = {}
    for path in tracked(root):
        if path.name == "CMakeLists.txt" and path.parts[0] in PRODUCT:
            for library in libraries_in(path.parent, (root / path).read_text()):
                found[library.name] = library
    return found


def reached(found, names):
    """`names` and all that they link in public, themselves included."""
    seen, waiting = set(), list(names)
    while waiting:
        name = waiting.pop()
        if name in found and name not in seen:
            seen.add(name)
            waiting += found[name].links
    return seen
