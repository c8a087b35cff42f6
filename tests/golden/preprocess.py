"""A preprocessor for the texts of uber/: conditions, includes and macros without parameters, into tokens.

It shares nothing with kiln's and is fast enough to be asked for every variant of a renderer; shipped.py asks glslc for some of them as
well. What it does not know, it refuses.
"""
import re

TOKEN = re.compile(r"[A-Za-z_]\w*|\d[\w.]*|\S")
CONDITION = re.compile(r"\|\||&&|==|!=|<=|>=|[A-Za-z_]\w*|\d\w*|\S")


def parse(text):
    """Lines as (what, rest): a directive with its text, or ("text", tokens), or ("as it is", tokens) for what no macro changes."""
    if "/*" in text or "\\\n" in text:
        raise ValueError("comments over lines and continued lines are not known here")
    out = []
    for line in text.split("\n"):
        line = line.split("//")[0].strip()
        directive = re.match(r"#\s*(if|ifdef|ifndef|elif|else|endif|define|include)\b\s*(.*)", line)
        if directive:
            out.append((directive[1], directive[2]))
        elif line.startswith("#") and not line.startswith(("#version", "#extension")):
            raise ValueError(line)
        elif line.startswith("#extension") and "GL_GOOGLE_include_directive" in line:
            continue
        elif line.startswith("#"):
            out.append(("as it is", TOKEN.findall(line)))
        elif line:
            out.append(("text", TOKEN.findall(line)))
    return out


class Preprocessor:
    def __init__(self, files):
        self.files = {name: parse(text) for name, text in files.items()}

    def words(self, name, seen=None):
        """Every word of a file and of what it includes, whether or not a condition lets it."""
        seen = {} if seen is None else seen
        if name not in seen:
            seen[name] = set()
            for what, rest in self.files[name]:
                if what == "include":
                    seen[name] |= self.words(self.included(name, rest), seen)
                else:
                    seen[name] |= set(rest if isinstance(rest, list) else TOKEN.findall(rest))
        return set().union(*seen.values())

    def included(self, name, rest):
        folder = name.rpartition("/")[0]
        path = (folder + "/" if folder else "") + rest.strip('"')
        return path if path in self.files else rest.strip('"')

    def tokens(self, name, macros):
        """macros: name to text."""
        out = []
        self.run(name, {k: TOKEN.findall(str(v)) for k, v in macros}, out)
        return out

    def run(self, name, macros, out):
        state = []  # of each open condition: whether this branch is taken, whether one was
        for what, rest in self.files[name]:
            if what in ("if", "ifdef", "ifndef"):
                outer = all(s[0] for s in state)
                holds = outer and (self.holds(rest, macros) if what == "if" else (rest in macros) == (what == "ifdef"))
                state.append([holds, holds or not outer])
            elif what == "elif":
                holds = not state[-1][1] and self.holds(rest, macros)
                state[-1] = [holds, state[-1][1] or holds]
            elif what == "else":
                state[-1] = [not state[-1][1], True]
            elif what == "endif":
                state.pop()
            elif state and not all(s[0] for s in state):
                continue
            elif what == "include":
                self.run(self.included(name, rest), macros, out)
            elif what == "define":
                macro = re.fullmatch(r"(\w+)(?:\s+(.*))?", rest)
                if not macro:
                    raise ValueError(f"{name}: macros with parameters are not known here: {rest}")
                macros[macro[1]] = TOKEN.findall(macro[2] or "")
            elif what == "as it is" or macros.keys().isdisjoint(rest):
                out += rest
            else:
                out += self.expanded(rest, macros, frozenset())
        if state:
            raise ValueError(f"{name}: a condition is left open")

    def expanded(self, tokens, macros, hidden):
        out = []
        for t in tokens:
            out += self.expanded(macros[t], macros, hidden | {t}) if t in macros and t not in hidden else [t]
        return out

    def holds(self, text, macros):
        text = re.sub(r"\bdefined\b\s*(\(\s*(\w+)\s*\)|(\w+))", lambda m: "1" if (m[2] or m[3]) in macros else "0", text)
        # Joined again, since an expansion may hold an operator of two characters.
        tokens = CONDITION.findall(" ".join(self.expanded(CONDITION.findall(text), macros, frozenset())))
        words = {"&&": " and ", "||": " or ", "!": " not "}
        python = "".join(words.get(t, "0" if re.match(r"[A-Za-z_]", t) else t) for t in tokens)
        if not re.fullmatch(r"(?: and | or | not |==|!=|<=|>=|[-+*/%()<>]|\d+)*", python):
            raise ValueError(text)
        return bool(eval(python))  # numbers and operators alone, as just seen
