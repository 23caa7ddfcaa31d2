"""Rewrites the SPIR-V of a fragment stage as GLSL of OpenGL 2.1, operation by operation, for a chip that has floats only.

The stage has one target, neither loops nor integers that the host gives: calls inlined, loops unrolled. What is not the same:

  - Integers and doubles are floats. A division of integers is floor((a + 0.5) / b), for what is divided here is never
    negative; a shift by n bits multiplies by 2^n or divides by it; & with 2^n - 1 is the remainder. The bits of a float less
    its sign are its absolute value.
  - texelFetch() looks a texture up at (place + 0.5) / size, a multiplication and an addition in one; a constant that the place
    was added to is in what is added. At the fragment's own place, and at one that the vertex program hands on, it takes an
    interpolated coordinate as it stands.
  - Layers of an array are textures of their own; where a fragment computes which, they stand above one another in one.
  - gl_FragCoord is interpolated like any other coordinate.
  - Whole numbers in textures need no conversion.
  - There is no `precise`. A sum that is precise keeps its operations as hide_sums() says.
"""
import re

OWN = "own"  # the fragment's own place, scaled as a look-up takes it
PLACE = "place"  # in texels
XYZW = "xyzw"
INFIX = {"FAdd": "+", "IAdd": "+", "FSub": "-", "ISub": "-", "FMul": "*", "IMul": "*", "FDiv": "/"}
COMPARED = {"Equal": ("==", "equal"), "NotEqual": ("!=", "notEqual"), "LessThan": ("<", "lessThan"),
            "GreaterThan": (">", "greaterThan"), "LessThanEqual": ("<=", "lessThanEqual"),
            "GreaterThanEqual": (">=", "greaterThanEqual")}  # fmt: skip
FUNCTIONS = {"FMin": "min", "SMin": "min", "UMin": "min", "FMax": "max", "SMax": "max", "UMax": "max", "FAbs": "abs",
             "SAbs": "abs", "FClamp": "clamp", "SClamp": "clamp", "UClamp": "clamp", "Sqrt": "sqrt",
             "InverseSqrt": "inversesqrt", "Exp": "exp", "Log": "log", "Cos": "cos", "Acos": "acos", "Normalize": "normalize",
             "Cross": "cross", "Floor": "floor", "FMix": "mix"}  # fmt: skip


class CannotRewrite(Exception):
    pass


def hide_sums(disassembly):
    """A stage's disassembly, not yet optimized (spirv-opt forgets what is precise when it unrolls a loop), where the first operand
    of each precise sum and difference is multiplied by a uniform, one: a multiply-add, of one slot as the sum was, and Mesa no
    longer finds that (a + b) - a is b. In differences the first, too, or it would find so in (a * one + b) - a * one. A sum of
    products stays as it is: a multiply-add already."""
    precise = set(re.findall(r"OpDecorate (%\w+) NoContraction", disassembly))
    products = set(re.findall(r"(%\w+) = Op(?:FMul|VectorTimesScalar) ", disassembly))
    lines, hidden, declared = [], 0, False
    for line in disassembly.splitlines():
        match = re.match(r"\s*(%\w+) = Op(FAdd|FSub) (%float|%v[234]float) (%\w+) (%\w+)$", line)
        if match and match[1] in precise and not {match[4], match[5]} & products:
            result, op, kind, first, second = match.groups()
            times = "FMul" if kind == "%float" else "VectorTimesScalar"
            lines += [f"%one_{hidden} = OpLoad %float %one", f"%times_one_{hidden} = Op{times} {kind} {first} %one_{hidden}"]
            line = f"{result} = Op{op} {kind} %times_one_{hidden} {second}"
            hidden += 1
        if re.match(r"\s*%\w+ = OpFunction ", line) and not declared:
            declared = True
            lines += ["%to_one = OpTypePointer UniformConstant %float", "%one = OpVariable %to_one UniformConstant"]
        lines.append(line)
    named = re.sub(r"^(\s*OpName )", r'OpName %one "one"\n\1', "\n".join(lines) + "\n", count=1, flags=re.M)
    return named if hidden else disassembly


class Stage:
    """One stage, from its disassembly. texture_sizes: sampler -> whose size it has, where that isn't its own."""

    def __init__(self, disassembly, texture_sizes):
        self.texture_sizes = texture_sizes
        self.shape_of, self.pointed, self.storage = {}, {}, {}  # types: (scalar, components); what pointers point to
        self.whole = set()  # types of integers
        self.type_of, self.constant, self.parts = {}, {}, {}  # of results; numbers; of what is composed
        self.variable, self.image = {}, {}  # where pointers lead: (name, indices)
        self.kind = {}  # result -> for each component where it is from
        self.splat = {}  # vectors whose components are all the same result
        self.sums = {}  # whole numbers, by component: (what is added up, the constant that is added)
        self.samplers, self.uniforms, self.varyings = {}, {}, {}
        self.locals, self.lines, self.indent = {}, [], "    "
        self.blocks, self.first = {}, None
        self.output = None
        self.read(disassembly)
        self.write_block(self.first, None)

    # Reading

    def read(self, disassembly):
        block = None
        for line in disassembly.splitlines():
            match = re.match(r"\s*(?:(%\w+) = )?Op(\w+)\s*(.*)$", line)
            if not match:
                continue
            result, op, rest = match[1], match[2], match[3].split()
            if block is None:
                self.declare(result, op, rest)
            if op == "Label":
                block = result
                self.blocks[block] = []
                self.first = self.first or block
            elif block:
                if op == "LoopMerge":
                    raise CannotRewrite("a loop that is not unrolled")
                self.blocks[block].append((result, op, rest))
        for instructions in self.blocks.values():
            for result, op, rest in instructions:
                if result and rest:
                    self.type_of[result] = rest[0]

    def declare(self, result, op, rest):
        if op in ("TypeInt", "TypeFloat"):
            self.shape_of[result] = ("float", 1)
            if op == "TypeInt":
                self.whole.add(result)
        elif op == "TypeBool":
            self.shape_of[result] = ("bool", 1)
        elif op == "TypeVector":
            self.shape_of[result] = (self.shape_of[rest[0]][0], int(rest[1]))
            if rest[0] in self.whole:
                self.whole.add(result)
        elif op == "TypeArray":
            self.shape_of[result] = ("array", int(self.constant[rest[1]]), rest[0])
        elif op == "TypePointer":
            self.pointed[result] = rest[1]
        elif op == "Variable":
            self.type_of[result] = rest[0]
            self.storage[result] = rest[1]
            self.variable[result] = (result.lstrip("%"), ())
        elif op in ("Constant", "ConstantTrue", "ConstantFalse"):
            self.type_of[result] = rest[0]
            text = rest[1] if op == "Constant" else str(int(op == "ConstantTrue"))
            self.constant[result] = float.fromhex(text) if "0x" in text else float(text)
        elif op == "ConstantComposite":
            self.type_of[result] = rest[0]
            self.parts[result] = rest[1:]
        elif op in ("ConstantNull", "Undef"):
            self.type_of[result] = rest[0]
            if self.shape_of[rest[0]][1] == 1:
                self.constant[result] = 0.0

    # What is known of a result

    def shape(self, result):
        return self.shape_of[self.type_of[result]]

    def components(self, result):
        return self.shape(result)[1]

    def glsl_type(self, type_name):
        scalar, count = self.shape_of[type_name][:2]
        return scalar if count == 1 else {"float": "vec", "bool": "bvec"}[scalar] + str(count)

    def kinds(self, result):
        return self.kind.get(result) or [None] * self.components(result)

    def number(self, result, component=0):
        """A component's value where it is constant, else None."""
        if result in self.constant:
            return self.constant[result]
        if result in self.parts:
            for part in self.parts[result]:
                count = self.components(part)
                if component < count:
                    return self.number(part, component)
                component -= count
            return None
        kind = self.kinds(result)[component]
        return kind[1] if kind and kind[0] == "number" else None

    def sum_of(self, result):
        """By component what is added up to it, and the constant that is added."""
        if result in self.sums:
            return self.sums[result]
        count = self.components(result)
        numbers = [self.number(result, i) for i in range(count)]
        names = [f"{self.text(result)}.{XYZW[i]}" if count > 1 else self.text(result) for i in range(count)]
        return [((name,), 0) if number is None else ((), int(number)) for name, number in zip(names, numbers)]

    @staticmethod
    def literal(number):
        text = repr(float(number))
        return text if "e" in text or "." in text else text + ".0"

    def text(self, result):
        """The result as GLSL writes it where it is used."""
        shape = self.shape_of[self.type_of[result]]
        if result in self.constant:
            return ("true" if self.constant[result] else "false") if shape[0] == "bool" else self.literal(self.constant[result])
        if result not in self.locals:
            if result in self.parts:
                return f"{self.glsl_type(self.type_of[result])}({', '.join(map(self.text, self.parts[result]))})"
            return f"{self.glsl_type(self.type_of[result])}({'false' if shape[0] == 'bool' else '0.0'})"  # undefined
        return self.locals[result]

    # Writing

    def put(self, line):
        self.lines.append(self.indent + line)

    def let(self, result, text, kind=None):
        self.locals[result] = "v" + result.lstrip("%")
        if kind:
            self.kind[result] = kind
        self.put(f"{self.locals[result]} = {text};")

    def write_block(self, label, until):
        while label != until:
            merge = None
            for result, op, rest in self.blocks[label]:
                if op == "SelectionMerge":
                    merge = rest[0]
                elif op == "Phi":
                    self.locals[result] = "v" + result.lstrip("%")
                elif op == "Branch":
                    self.leave(label, rest[0])
                    label = rest[0]
                    break
                elif op == "BranchConditional":
                    condition, yes, no = rest[:3]
                    for target, head in ((yes, f"if ({self.text(condition)}) {{"), (no, "} else {")):
                        self.put(head)
                        self.indent += "    "
                        if target == merge:
                            self.leave(label, target)
                        else:
                            self.write_block(target, merge)
                        self.indent = self.indent[4:]
                    self.put("}")
                    label = merge
                    break
                elif op == "Return":
                    return
                else:
                    self.write(result, op, rest)

    def leave(self, label, target):
        """Values that the target's phis take when it is reached from this block."""
        for result, op, rest in self.blocks[target]:
            if op == "Phi":
                pairs = dict(zip(rest[2::2], rest[1::2]))
                if label in pairs:
                    self.put(f"v{result.lstrip('%')} = {self.text(pairs[label])};")

    def write(self, result, op, rest):
        if op in ("Load", "AccessChain", "Image", "Store", "ImageFetch", "ImageQuerySizeLod"):
            return self.write_memory(result, op, rest)
        if op.startswith("Composite") or op.startswith("Vector"):
            return self.write_vector(result, op, rest)
        return self.write_arithmetic(result, op, rest)

    def write_memory(self, result, op, rest):
        if op == "AccessChain":
            name, indices = self.variable[rest[1]]
            more = [self.number(index) for index in rest[2:]]
            if None in more:
                raise CannotRewrite(f"{name}: an index that is computed")
            self.storage[result] = self.storage[rest[1]]
            self.variable[result] = (name, indices + tuple(int(index) for index in more))
        elif op == "Load":
            self.write_load(result, rest[1])
        elif op == "Image":
            self.image[result] = self.image[rest[1]]
        elif op == "ImageQuerySizeLod":
            size = self.size_of(self.image[rest[1]])
            self.uniforms[size + "_texels"] = self.glsl_type(rest[0])
            self.let(result, size + "_texels")
        elif op == "Store":
            name, indices = self.variable[rest[0]]
            if self.storage[rest[0]] != "Output" or indices not in ((), (0,)):
                raise CannotRewrite(f"{name}: a variable that is not taken apart")
            self.output = "written_" + name
            self.put(f"{self.output} = {self.as_vec4(rest[1])};")
        else:
            self.write_fetch(result, rest)

    def as_vec4(self, result):
        missing = 4 - self.components(result)
        return f"vec4({', '.join([self.text(result)] + ['0.0'] * missing)})" if missing else self.text(result)

    def write_load(self, result, pointer):
        name, indices = self.variable[pointer]
        storage = self.storage[pointer]
        shape = self.shape_of.get(self.type_of[result])
        if shape is None:  # a sampler
            self.image[result] = (name, indices)
            return
        swizzle = XYZW[: shape[1]] if shape[0] != "array" else ""
        if storage == "Input":
            if name == "gl_FragCoord":
                self.varyings[PLACE] = True
                self.let(result, f"vec4({PLACE}.xy, 0.0, 1.0)", [("place", 0), ("place", 1), None, None])
            else:
                self.varyings[name] = True
                first = indices[0] if indices else 0
                self.let(result, f"{name}.{XYZW[first : first + shape[1]]}", [("given", name, first + i) for i in range(shape[1])])
        elif storage == "Output":
            self.let(result, f"written_{name}.{swizzle}")
        else:
            declared = self.pointed[self.type_of["%" + name]]
            whole = self.shape_of[declared]
            component = ""
            if whole[0] == "array":
                element = self.shape_of[whole[2]]
                if not indices:
                    raise CannotRewrite(f"{name}: an array that is not taken apart")
                name, indices, whole = f"{name}_{indices[0]}", indices[1:], element
            if indices:
                component = "." + XYZW[indices[0]]
            # A register of the chip holds four numbers.
            self.uniforms[name] = {1: "float", 2: "vec2", 3: "vec3", 4: "vec4"}[whole[1]]
            self.let(result, name + component)

    def size_of(self, image):
        return self.texture_sizes.get(image[0], image[0])

    def write_fetch(self, result, rest):
        image, coordinate = self.image[rest[1]], rest[2]
        layer, above = "", None
        if self.components(coordinate) == 3:
            number = self.number(coordinate, 2)
            if number is None:
                above = f"{self.text(coordinate)}.z"
            else:
                layer = f"_{int(number)}"
        sampler = "_".join([image[0], *map(str, image[1])]) + layer
        self.samplers[sampler] = True
        size = self.size_of(image)
        kinds = self.kinds(coordinate)[:2]
        if kinds == [("own", 0), ("own", 1)]:
            self.varyings[OWN] = True
            where = f"{OWN}.xy"
        elif kinds[0] and kinds[0][0] == "given" and kinds == [("given", kinds[0][1], 0), ("given", kinds[0][1], 1)]:
            where = f"{kinds[0][1]}_scaled.xy"
            self.varyings[f"{kinds[0][1]}_scaled"] = True
        else:
            where, half = f"{self.text(coordinate)}.xy", size + "_half"
            (x, right), (y, up) = self.sum_of(coordinate)[:2]
            if above:
                self.uniforms[size + "_rows"] = "float"
                where = f"vec2({self.text(coordinate)}.x, {self.text(coordinate)}.y + {above} * {size}_rows)"
            elif right or up:
                where = f"vec2({' + '.join(x) or '0.0'}, {' + '.join(y) or '0.0'})"
                half += f"_{right}_{up}".replace("-", "m")
            self.uniforms[size + "_scale"] = self.uniforms[half] = "vec2"
            where = f"{where} * {size}_scale + {half}"
        self.let(result, f"texture2D({sampler}, {where})", [("texel",)] * 4)

    def write_vector(self, result, op, rest):
        text, kinds = self.text, self.kinds
        if op == "CompositeConstruct":
            parts = rest[1:]
            self.parts[result] = parts
            kind = sum((self.kinds_or_numbers(part) for part in parts), [])
            if len(set(parts)) == 1 and self.components(parts[0]) == 1:
                self.splat[result] = parts[0]
            if rest[0] in self.whole:
                self.sums[result] = sum((self.sum_of(part) for part in parts), [])
            self.let(result, f"{self.glsl_type(rest[0])}({', '.join(map(text, parts))})", kind)
        elif op == "CompositeExtract":
            if rest[0] in self.whole:
                self.sums[result] = [self.sum_of(rest[1])[int(rest[2])]]
            self.let(result, f"{text(rest[1])}.{XYZW[int(rest[2])]}", [self.kinds_or_numbers(rest[1])[int(rest[2])]])
        elif op == "CompositeInsert":
            at, old = int(rest[3]), rest[2]
            parts = [f"{text(old)}.{XYZW[i]}" if i != at else text(rest[1]) for i in range(self.components(result))]
            self.let(result, f"{self.glsl_type(rest[0])}({', '.join(parts)})")
        elif op == "VectorShuffle":
            first = self.components(rest[1])
            which = [int(number) for number in rest[3:]]
            both = self.kinds_or_numbers(rest[1]) + self.kinds_or_numbers(rest[2])
            kind = [both[number] for number in which]
            if rest[0] in self.whole:
                added = self.sum_of(rest[1]) + self.sum_of(rest[2])
                self.sums[result] = [added[number] for number in which]
            if max(which) < first:
                self.let(result, f"{text(rest[1])}.{''.join(XYZW[number] for number in which)}", kind)
            else:
                parts = [f"{text(rest[1])}.{XYZW[n]}" if n < first else f"{text(rest[2])}.{XYZW[n - first]}" for n in which]
                self.let(result, f"{self.glsl_type(rest[0])}({', '.join(parts)})", kind)
        elif op == "VectorExtractDynamic":
            vector, at = text(rest[1]), text(rest[2])
            chosen = f"{vector}.{XYZW[self.components(rest[1]) - 1]}"
            for number in reversed(range(self.components(rest[1]) - 1)):
                chosen = f"({at} < {number + 0.5} ? {vector}.{XYZW[number]} : {chosen})"
            self.let(result, chosen, [kinds(rest[1])[0]] if kinds(rest[1])[0] == ("texel",) else None)
        elif op == "VectorTimesScalar":
            self.let(result, f"{text(rest[1])} * {text(rest[2])}")
        else:
            raise CannotRewrite(f"Op{op}")

    def kinds_or_numbers(self, result):
        kinds = self.kinds(result)
        numbers = [self.number(result, i) for i in range(self.components(result))]
        return [("number", number) if number is not None else kind for kind, number in zip(kinds, numbers)]

    def divided(self, a, b):
        """floor((a + 0.5) / b), whose constants fold where b is one."""
        number = self.number(b)
        same = all(self.number(b, i) == number for i in range(self.components(b)))
        if number and same:
            return f"floor({self.text(a)} * {self.literal(1 / number)} + {self.literal(0.5 / number)})"
        if number:
            over = [self.number(b, i) for i in range(self.components(b))]
            scale, half = (", ".join(self.literal(x / n) for n in over) for x in (1, 0.5))
            kind = self.glsl_type(self.type_of[b])
            return f"floor({self.text(a)} * {kind}({scale}) + {kind}({half}))"
        return f"floor(({self.text(a)} + 0.5) / {self.text(b)})"

    def write_arithmetic(self, result, op, rest):
        text = self.text
        a = rest[1] if len(rest) > 1 else None
        b = rest[2] if len(rest) > 2 else None
        compared = re.fullmatch(r"(?:FOrd|FUnord|S|U|I)(Equal|NotEqual|LessThan|GreaterThan|LessThanEqual|GreaterThanEqual)", op)
        if op in INFIX:
            numbers = [(self.number(a, i), self.number(b, i)) for i in range(self.components(result))]
            kind = [None] * len(numbers)
            if op in ("IAdd", "ISub", "IMul"):
                work = {"IAdd": lambda x, y: x + y, "ISub": lambda x, y: x - y, "IMul": lambda x, y: x * y}[op]
                kind = [("number", work(*both)) if None not in both else None for both in numbers]
            if op in ("IAdd", "ISub"):
                self.add_up(result, op, a, b)
            self.let(result, f"{text(a)} {INFIX[op]} {text(b)}", kind)
        elif op in ("SDiv", "UDiv"):
            self.let(result, self.divided(a, b))
        elif op in ("SMod", "UMod", "SRem"):
            self.let(result, f"{text(a)} - {text(b)} * {self.divided(a, b)}")
        elif op in ("ShiftRightLogical", "ShiftRightArithmetic"):
            self.let(result, f"floor({text(a)} * {self.literal(2.0 ** -self.number(b))})")
        elif op == "ShiftLeftLogical":
            self.let(result, f"{text(a)} * {self.literal(2.0 ** self.number(b))}")
        elif op == "BitwiseAnd":
            self.write_mask(result, a, b)
        elif op == "ULessThan" and self.kinds(a)[0] == ("magnitude",):
            self.let(result, f"{text(a)} < {self.literal(float_of_bits(self.number(b)))}")
        elif compared:
            infix, function = COMPARED[compared[1]]
            vector = self.components(result) > 1
            self.let(result, f"{function}({text(a)}, {text(b)})" if vector else f"{text(a)} {infix} {text(b)}")
        elif op == "Select":
            self.write_select(result, rest)
        elif op in ("SNegate", "FNegate"):
            self.let(result, f"-{text(a)}")
        elif op == "Dot":
            self.let(result, f"dot({text(a)}, {text(b)})")
        elif op in ("LogicalAnd", "LogicalOr", "LogicalEqual", "LogicalNotEqual"):
            if self.components(result) > 1:
                raise CannotRewrite(f"Op{op} of vectors")
            sign = {"LogicalAnd": "&&", "LogicalOr": "||", "LogicalEqual": "==", "LogicalNotEqual": "!="}[op]
            self.let(result, f"{text(a)} {sign} {text(b)}")
        elif op == "LogicalNot":
            self.let(result, f"!{text(a)}" if self.components(result) == 1 else f"not({text(a)})")
        elif op in ("All", "Any"):
            self.let(result, f"{op.lower()}({text(a)})")
        elif op in ("ConvertSToF", "ConvertUToF", "FConvert", "UConvert", "SConvert", "CopyObject"):
            self.let(result, text(a), self.kinds_or_numbers(a))
        elif op in ("ConvertFToS", "ConvertFToU"):
            self.write_whole(result, a)
        elif op == "Bitcast":
            self.let(result, text(a), self.kinds_or_numbers(a))
        elif op == "ExtInst":
            self.write_function(result, rest[2], rest[3:])
        else:
            raise CannotRewrite(f"Op{op}")

    def add_up(self, result, op, a, b):
        """Keeps what a sum of whole numbers is of; of a difference only where a constant is subtracted."""
        sums = []
        for (of_a, more), (of_b, yet_more) in zip(self.sum_of(a), self.sum_of(b)):
            if op == "ISub" and of_b:
                return
            sums.append((tuple(sorted(of_a + of_b)), more - yet_more if op == "ISub" else more + yet_more))
        self.sums[result] = sums

    def write_mask(self, result, a, b):
        mask = self.number(b)
        if mask == 0x7FFFFFFF:
            self.let(result, f"abs({self.text(a)})", [("magnitude",)])
        elif mask is not None and int(mask) & (int(mask) + 1) == 0:
            self.let(result, f"{self.text(a)} - {self.literal(mask + 1)} * floor({self.text(a)} * {self.literal(1 / (mask + 1))})")
        else:
            raise CannotRewrite("& of other than the lowest bits")

    def write_whole(self, result, a):
        kinds = [kind and kind[0] for kind in self.kinds(a)]
        if all(kind == "place" for kind in kinds):
            self.let(result, f"floor({self.text(a)})", [("own", kind[1]) for kind in self.kinds(a)])
        elif all(kind in ("texel", "whole") for kind in kinds):
            self.let(result, self.text(a), self.kinds(a))
        else:
            self.let(result, f"floor({self.text(a)})", [("whole",)] * self.components(result))

    def write_select(self, result, rest):
        condition, yes, no = rest[1:4]
        condition = self.splat.get(condition, condition)
        if self.components(condition) == 1:
            self.let(result, f"{self.text(condition)} ? {self.text(yes)} : {self.text(no)}")
        else:
            self.let(result, f"mix({self.text(no)}, {self.text(yes)}, {self.text(condition)})")

    def write_function(self, result, name, rest):
        if name == "Fma":
            self.let(result, "{} * {} + {}".format(*map(self.text, rest)))
        elif name in FUNCTIONS:
            kind = [("whole",)] * self.components(result) if name == "Floor" else None
            self.let(result, f"{FUNCTIONS[name]}({', '.join(map(self.text, rest))})", kind)
        else:
            raise CannotRewrite(name)

    def glsl(self, version):
        """The fragment program, and a vertex program that hands on what it reads."""
        results = sorted({line.split(" = ")[0].strip() for line in self.lines if re.match(r"\s*v\w+ = ", line)})
        declared = [f"    {self.glsl_type(self.type_of['%' + name[1:]])} {name};" for name in results]
        varyings = [f"varying vec4 {name};" for name in sorted(self.varyings)]
        head = [f"#version {version}", *varyings]
        fragment = head + [f"uniform {kind} {name};" for name, kind in sorted(self.uniforms.items())]
        fragment += [f"uniform sampler2D {name};" for name in sorted(self.samplers)]
        fragment += ["void main() {", f"    vec4 {self.output};", *declared, *self.lines, f"    gl_FragColor = {self.output};", "}"]
        given = sorted(self.varyings)
        vertex = head + ["attribute vec4 position;"] + [f"attribute vec4 given_{name};" for name in given]
        vertex += ["void main() {", "    gl_Position = position;", *(f"    {name} = given_{name};" for name in given), "}"]
        return "\n".join(fragment) + "\n", "\n".join(vertex) + "\n"


def float_of_bits(bits):
    """The float whose bits a whole number is."""
    bits = int(bits)
    return (1 + (bits & 0x7FFFFF) / 0x800000) * 2.0 ** ((bits >> 23) - 127)
