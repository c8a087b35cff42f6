"""What `kiln count` must say, found another way: every combination is listed and asked, every text is preprocessed by glslc.

A case is a manifest as Python values. Rules are read by the small evaluator here, which shares nothing with kiln's.
"""
import pathlib
import re
import subprocess
import tempfile

TOKEN = re.compile(r"\s*(->|\|\||&&|==|!=|<=|>=|[!<>(){},]|-?\d\w*|[A-Za-z_]\w*)")


def numbers(axis):
    """The axis's values as a dict name -> number, in order."""
    values = axis["values"]
    if values in ("bool", "defined"):
        return {"false": 0, "true": 1}
    if isinstance(values, dict):
        return dict(values)
    if isinstance(values[0], int):
        return {str(v): v for v in values}
    return {name: i for i, name in enumerate(values)}


class Rule:
    """expression = or [-> expression];  or = and {|| and};  and = not {&& not};  not = ! not | comparison"""

    def __init__(self, text, axes):
        self.tokens = TOKEN.findall(text) + [""]
        self.axes, self.at = axes, 0
        self.tree = self.implies()
        assert self.tokens[self.at] == "", text

    def take(self, *wanted):
        if self.tokens[self.at] in wanted:
            self.at += 1
            return self.tokens[self.at - 1]
        return None

    def implies(self):
        left = self.binary(("||",), lambda: self.binary(("&&",), self.negation))
        if self.take("->"):
            right = self.implies()
            return lambda v: not left(v) or right(v)
        return left

    def binary(self, operators, below):
        terms = [below()]
        while self.take(*operators):
            terms.append(below())
        if len(terms) == 1:
            return terms[0]
        joined = any if operators == ("||",) else all
        return lambda v: joined([t(v) for t in terms])

    def negation(self):
        if self.take("!", "not"):
            inner = self.negation()
            return lambda v: not inner(v)
        return self.comparison()

    def comparison(self):
        if self.take("("):
            inner = self.implies()
            assert self.take(")")
            return inner
        left, axis = self.operand(None)
        operator = self.take("==", "!=", "<=", ">=", "<", ">", "in")
        if operator is None:
            return lambda v: left(v) != 0
        if operator == "in":
            assert self.take("{")
            members = [self.operand(axis)[0]]
            while self.take(","):
                members.append(self.operand(axis)[0])
            assert self.take("}")
            return lambda v: left(v) in [m(v) for m in members]
        right, _ = self.operand(axis)
        compare = {"==": int.__eq__, "!=": int.__ne__, "<=": int.__le__, ">=": int.__ge__, "<": int.__lt__, ">": int.__gt__}
        return lambda v: compare[operator](left(v), right(v))

    def operand(self, axis):
        token = self.tokens[self.at]
        self.at += 1
        if re.match(r"-?\d", token):
            return (lambda v, n=int(token, 0): n), None
        if axis is not None and token in numbers(self.axes[axis]):
            return (lambda v, n=numbers(self.axes[axis])[token]: n), None
        assert token in self.axes, token
        return (lambda v, a=token: v[a]), token


def legal_variants(axes, rules):
    """Every legal combination as a dict axis -> number. rules: [("forbid" | "require", text)]."""
    # A rule is asked as soon as all of its axes have values, so that whole branches fall away.
    names = list(axes)
    asked_at = {name: [] for name in names}
    for kind, text in rules:
        rule = Rule(text, axes)
        last = max((names.index(t) for t in rule.tokens if t in axes), default=0)
        asked_at[names[last]].append((kind == "forbid", rule.tree))

    def extend(v):
        if len(v) == len(names):
            yield dict(v)
            return
        name = names[len(v)]
        for number in numbers(axes[name]).values():
            v[name] = number
            if all(bool(tree(v)) != forbid for forbid, tree in asked_at[name]):
                yield from extend(v)
        v.pop(name)

    yield from extend({})


def declared(axes):
    product = 1
    for axis in axes.values():
        product *= len(numbers(axis))
    return product


def tokens_of(folder, file, stage, macros):
    command = ["glslc", "-E", f"-fshader-stage={stage}", *(f"-D{k}={v}" for k, v in macros), file]
    text = subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout
    kept = [line for line in text.split("\n") if not line.startswith(("#line", "#extension GL_GOOGLE_include_directive"))]
    return re.findall(r"[A-Za-z_]\w*|\d[\w.]*|\S", "\n".join(kept))


def classes(files, file, stage, axes, variants, fixed=()):
    """Distinct token streams of one stage over `variants`. A macro whose name stands in no file cannot change a text."""
    words = set(re.findall(r"\w+", "\n".join(files.values())))
    asked, seen = set(), set()
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        for v in variants:
            macros = list(fixed)
            for name, axis in axes.items():
                if axis["values"] == "defined" and v[name] == 0:
                    continue
                if axis["macro"] in words:
                    macros.append((axis["macro"], v[name]))
            if tuple(macros) not in asked:
                asked.add(tuple(macros))
                seen.add(tuple(tokens_of(folder, file, stage, macros)))
    return len(seen)
