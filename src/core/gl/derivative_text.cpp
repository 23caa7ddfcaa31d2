#include "gl/derivative_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string_view>
#include <vector>

#include "gl/text_scanner.h"

namespace radiafit {
namespace {

/// What a number that carries derivatives is called, and all that is made of it.
struct Kind {
    std::string prefix;   ///< before names of types and functions
    const char* numbers;  ///< the type, its constants and its functions, P for the prefix, N for the type
};

/// Of all functions of numbers. N is the type.
constexpr const char* of_vectors = R"(
struct P3 { N x; N y; N z; };
P3 P_add(P3 a, P3 b) { return P3(P_add(a.x, b.x), P_add(a.y, b.y), P_add(a.z, b.z)); }
P3 P_subtract(P3 a, P3 b) { return P3(P_subtract(a.x, b.x), P_subtract(a.y, b.y), P_subtract(a.z, b.z)); }
P3 P_multiply(P3 a, P3 b) { return P3(P_multiply(a.x, b.x), P_multiply(a.y, b.y), P_multiply(a.z, b.z)); }
P3 P_multiply(P3 a, N b) { return P_multiply(a, P3(b, b, b)); }
P3 P_multiply(N a, P3 b) { return P_multiply(P3(a, a, a), b); }
bool P_less(N a, N b) { return a.v < b.v; }
bool P_less_equal(N a, N b) { return a.v <= b.v; }
bool P_greater(N a, N b) { return a.v > b.v; }
bool P_greater_equal(N a, N b) { return a.v >= b.v; }
N P_max(N a, N b) { return P_select(a.v < b.v, b, a); }
N P_min(N a, N b) { return P_select(b.v < a.v, b, a); }
)";

const Kind slope{"slope_", R"(
struct N { float v; float d[SHAPE_COUNT]; };
N P_number(float v) { N y; y.v = v; for (int i = 0; i < SHAPE_COUNT; ++i) y.d[i] = 0.0; return y; }
N P_number(N x) { return x; }
N P_of(float v, float by, N a) { N y; y.v = v; for (int i = 0; i < SHAPE_COUNT; ++i) y.d[i] = by * a.d[i]; return y; }
N P_of(float v, float by_a, N a, float by_b, N b) {
    N y;
    y.v = v;
    for (int i = 0; i < SHAPE_COUNT; ++i) y.d[i] = by_a * a.d[i] + by_b * b.d[i];
    return y;
}
N P_add(N a, N b) { return P_of(a.v + b.v, 1.0, a, 1.0, b); }
N P_subtract(N a, N b) { return P_of(a.v - b.v, 1.0, a, -1.0, b); }
N P_multiply(N a, N b) { return P_of(a.v * b.v, b.v, a, a.v, b); }
N P_divide(N a, N b) { float y = a.v / b.v; return P_of(y, 1.0 / b.v, a, -y / b.v, b); }
N P_minus(N a) { return P_of(-a.v, -1.0, a); }
N P_exp(N a) { float y = exp(a.v); return P_of(y, y, a); }
N P_log(N a) { return P_of(log(a.v), 1.0 / a.v, a); }
N P_sqrt(N a) { float y = sqrt(a.v); return P_of(y, y > 0.0 ? 0.5 / y : 0.0, a); }
N P_select(bool c, N a, N b) {
    N y;
    y.v = c ? a.v : b.v;
    for (int i = 0; i < SHAPE_COUNT; ++i) y.d[i] = c ? a.d[i] : b.d[i];
    return y;
}
)"};

const Kind bend{"bend_", R"(
struct N { float v; float d; float e; };
N P_number(float v) { return N(v, 0.0, 0.0); }
N P_number(N x) { return x; }
N P_of(float v, float first, float second, N a) { return N(v, first * a.d, second * a.d * a.d + first * a.e); }
N P_add(N a, N b) { return N(a.v + b.v, a.d + b.d, a.e + b.e); }
N P_subtract(N a, N b) { return N(a.v - b.v, a.d - b.d, a.e - b.e); }
N P_multiply(N a, N b) { return N(a.v * b.v, a.d * b.v + a.v * b.d, a.e * b.v + 2.0 * a.d * b.d + a.v * b.e); }
N P_divide(N a, N b) {
    float y = a.v / b.v;
    float d = (a.d - y * b.d) / b.v;
    return N(y, d, (a.e - 2.0 * d * b.d - y * b.e) / b.v);
}
N P_minus(N a) { return N(-a.v, -a.d, -a.e); }
N P_exp(N a) { float y = exp(a.v); return P_of(y, y, y, a); }
N P_log(N a) { float over = 1.0 / a.v; return P_of(log(a.v), over, -over * over, a); }
N P_sqrt(N a) {
    float y = sqrt(a.v), over = y > 0.0 ? 0.5 / y : 0.0;
    return P_of(y, over, y > 0.0 ? -0.5 * over / a.v : 0.0, a);
}
N P_select(bool c, N a, N b) { return N(c ? a.v : b.v, c ? a.d : b.d, c ? a.e : b.e); }
)"};

/// P and N, as words or before _ and 3, in place of the prefix and the type.
std::string named(const std::string& text, const std::string& prefix) {
    std::string out;
    const auto word = [](char c) { return std::isalnum(uint8_t(c)) || c == '_'; };
    for (size_t i = 0; i < text.size();) {
        size_t end = i + 1;
        if (!word(text[i])) {
            out += text[i++];
            continue;
        }
        while (end < text.size() && word(text[end])) ++end;
        const std::string found = text.substr(i, end - i);
        if (found == "N")
            out += prefix + "real";
        else if (found == "P3")
            out += prefix + "real3";
        else if (found.starts_with("P_"))
            out += prefix + found.substr(2);
        else
            out += found;
        i = end;
    }
    return out;
}

/// The structs and functions of a text, over another number.
class Translator {
public:
    Translator(std::string file, const TextScanner& scanner, const Kind& kind)
        : file_(std::move(file)), scanner_(&scanner), tokens_(&scanner.tokens()), kind_(&kind) {
        find_declarations();
    }

    bool has_struct(const std::string& name) const { return structs_.contains(name); }
    /// basis() and all that it calls.
    std::string translated() {
        std::string out = named(kind_->numbers, kind_->prefix) + named(of_vectors, kind_->prefix);
        for (const std::string& name : order_)
            if (name != "Slope") out += "struct " + own(name) + " {" + members_of(structs_.at(name)) + "};\n";
        need("basis", 1);
        for (const std::string& name : function_order_)
            if (bodies_.contains(name)) out += bodies_.at(name);
        return out;
    }

private:
    static constexpr const char* known[] = {"exp", "log", "sqrt", "max", "min"};

    const Token& at(size_t i) const {
        static const Token end{";", 0};
        if (i >= tokens_->size())
            refuse_text(file_, tokens_->empty() ? 1 : tokens_->back().line, "the text ends within a statement");
        return (*tokens_)[i];
    }
    std::string prefixed(const std::string& name) const { return kind_->prefix + name; }
    /// Of the text's own structs and functions, apart from those of numbers.
    std::string own(const std::string& name) const { return kind_->prefix + "own_" + name; }
    [[noreturn]] void unexpected(size_t i) const {
        refuse_text(file_, at(i).line, fmt::format("'{}' is not in the dialect of models here", at(i).text));
    }
    void expect(size_t& i, const char* text) const {
        if (at(i).text != text)
            refuse_text(file_, at(i).line, fmt::format("'{}' where '{}' should be", at(i).text, text));
        ++i;
    }
    /// Behind the bracket that closes the one at i.
    size_t behind(size_t i, const char* open, const char* close) const {
        int depth = 0;
        do {
            depth += at(i).text == open ? 1 : at(i).text == close ? -1 : 0;
            ++i;
        } while (depth > 0);
        return i;
    }
    void find_declarations() {
        for (size_t i = 0; i < tokens_->size();) {
            if (at(i).text == "struct") {
                structs_[at(i + 1).text] = i + 2;
                order_.push_back(at(i + 1).text);
                i = behind(i + 2, "{", "}");
                expect(i, ";");
                continue;
            }
            if (at(i).text == "SHARED_FN") ++i;
            const std::string name = at(i + 1).text;
            if (at(i + 2).text != "(") unexpected(i + 2);
            if (functions_.contains(name))
                refuse_text(file_, at(i).line,
                            fmt::format("two functions named {}, of which no derivatives are made", name));
            functions_[name] = i;
            function_order_.push_back(name);
            i = behind(behind(i + 2, "(", ")"), "{", "}");
        }
    }
    /// Its members, between braces from i on.
    std::string members_of(size_t i) const {
        std::string out;
        for (++i; at(i).text != "}";) {
            const std::string type = type_at(i);
            out += " " + type + " ";
            for (; at(i).text != ";"; ++i) out += at(i).text;
            out += ";";
            ++i;
        }
        return out + " ";
    }
    bool is_type(const Token& t) const {
        return t.text == "real" || t.text == "real2" || t.text == "real3" || t.text == "real4" || t.text == "int" ||
               t.text == "bool" || structs_.contains(t.text);
    }
    /// Over the kind's numbers; moves behind it.
    std::string type_at(size_t& i) const {
        const Token& t = at(i);
        if (t.text == "real2" || t.text == "real4")
            refuse_text(file_, t.line,
                        fmt::format("{} where derivatives are made: take numbers one by one, or real3", t.text));
        if (!is_type(t)) unexpected(i);
        ++i;
        if (t.text == "int" || t.text == "bool") return t.text;
        return structs_.contains(t.text) ? own(t.text) : prefixed(t.text);
    }

    /// A function is translated when it is first called.
    void need(const std::string& name, int line) {
        if (bodies_.contains(name)) return;
        if (name == "if" || name == "while")
            refuse_text(file_, line, fmt::format("'{}' is not in the dialect of models; take SELECT", name));
        if (!functions_.contains(name)) refuse_text(file_, line, fmt::format("no function {}", name));
        if (!under_way_.insert(name).second) refuse_text(file_, line, fmt::format("{} calls itself", name));
        size_t i = functions_.at(name);
        std::string out = type_at(i) + " " + own(name) + "(";
        i += 1;
        expect(i, "(");
        while (at(i).text != ")") {
            if (at(i).text == "INOUT") {
                i += 2;
                out += "inout " + type_at(i);
                expect(i, ")");
            } else {
                out += type_at(i);
            }
            out += " " + at(i++).text;
            if (at(i).text == ",") out += at(i++).text + " ";
        }
        out += ") ";
        ++i;
        out += block(i) + "\n";
        bodies_[name] = out;
    }
    std::string block(size_t& i) {
        expect(i, "{");
        std::string out = "{\n";
        while (at(i).text != "}") out += statement(i);
        ++i;
        return out + "}";
    }
    std::string statement(size_t& i) {
        const Token& t = at(i);
        if (t.text == "{") return block(i) + "\n";
        if (t.text == "for") {
            const size_t body = behind(i + 1, "(", ")");
            std::string out;
            for (; i < body; ++i) out += at(i).text + (at(i).name() ? " " : "");
            return out + " " + statement(i);
        }
        if (t.text == "return") {
            ++i;
            const std::string value = expression(i);
            expect(i, ";");
            return "return " + value + ";\n";
        }
        if (t.text == "int") {  // counts: as they are
            std::string out;
            for (; at(i).text != ";"; ++i) out += at(i).text + " ";
            ++i;
            return out + ";\n";
        }
        if (t.text == "const") return ++i, "const " + statement(i);
        if (t.name() && is_type(t) && at(i + 1).name()) {
            std::string out = type_at(i);
            for (;;) {
                out += " " + at(i++).text;
                if (at(i).text == "[") {
                    const size_t end = behind(i, "[", "]");
                    for (; i < end; ++i) out += at(i).text;
                }
                if (at(i).text == "=") out += " = " + expression(++i);
                if (at(i).text != ",") break;
                out += ",", ++i;
            }
            expect(i, ";");
            return out + ";\n";
        }
        const std::string target = postfix(i), op = at(i).text;
        ++i;
        std::string value = expression(i);
        if (op != "=") {
            const auto* found = function_of(op.substr(0, 1));
            if (op.size() != 2 || op[1] != '=' || !found)
                refuse_text(file_, t.line, fmt::format("'{}' where a value should be set", op));
            value = prefixed(found) + "(" + target + ", " + value + ")";
        }
        expect(i, ";");
        return target + " = " + value + ";\n";
    }

    static const char* function_of(const std::string& op) {
        static const std::map<std::string, const char*> all = {
            {"+", "add"},  {"-", "subtract"},    {"*", "multiply"}, {"/", "divide"},
            {"<", "less"}, {"<=", "less_equal"}, {">", "greater"},  {">=", "greater_equal"}};
        const auto found = all.find(op);
        return found == all.end() ? nullptr : found->second;
    }
    /// Operators that bind at least as strongly; those of a level from left to right.
    std::string expression(size_t& i, int level = 0) {
        static const std::vector<std::vector<std::string>> levels = {
            {"||"}, {"&&"}, {"<", "<=", ">", ">="}, {"+", "-"}, {"*", "/"}};
        if (level == int(levels.size())) return prefix(i);
        std::string left = expression(i, level + 1);
        while (std::ranges::find(levels[size_t(level)], at(i).text) != levels[size_t(level)].end()) {
            const std::string op = at(i++).text, right = expression(i, level + 1);
            const char* function = function_of(op);
            left = function ? prefixed(function) + "(" + left + ", " + right + ")"
                            : "(" + left + " " + op + " " + right + ")";
        }
        return left;
    }
    std::string prefix(size_t& i) {
        if (at(i).text == "-") return prefixed("minus") + "(" + prefix(++i) + ")";
        if (at(i).text == "!") return "!" + prefix(++i);
        return postfix(i);
    }
    std::string arguments(size_t& i) {
        std::string out;
        expect(i, "(");
        while (at(i).text != ")") {
            out += expression(i);
            if (at(i).text == ",") out += ", ", ++i;
        }
        ++i;
        return out;
    }
    std::string postfix(size_t& i) {
        const Token& t = at(i);
        std::string out;
        if (t.text == "(") {
            out = "(" + expression(++i) + ")";
            expect(i, ")");
        } else if (t.name() && at(i + 1).text == "(") {
            ++i;
            if (t.text == "real") {  // of a plain constant, or of a number
                const size_t end = behind(i, "(", ")");
                const bool constant =
                    std::none_of(tokens_->begin() + std::ptrdiff_t(i), tokens_->begin() + std::ptrdiff_t(end),
                                 [](const Token& x) { return x.name(); });
                if (constant) {
                    out = prefixed("number") + "(float";
                    for (; i < end; ++i) out += at(i).text;
                    out += ")";
                } else {
                    out = prefixed("number") + "(" + arguments(i) + ")";
                }
            } else if (t.text == "SELECT") {
                out = prefixed("select") + "(" + arguments(i) + ")";
            } else if (std::ranges::find(known, t.text) != std::end(known)) {
                out = prefixed(t.text) + "(" + arguments(i) + ")";
            } else if (is_type(t)) {
                out = (structs_.contains(t.text) ? own(t.text) : prefixed(t.text)) + "(" + arguments(i) + ")";
            } else {
                need(t.text, t.line);
                out = own(t.text) + "(" + arguments(i) + ")";
            }
        } else if (t.name() || std::isdigit(uint8_t(t.text[0]))) {
            out = scanner_->defines(t.text) ? prefixed("number") + "(float(" + t.text + "))" : t.text;
            ++i;
        } else {
            unexpected(i);
        }
        for (;;) {
            if (at(i).text == ".") {
                out += "." + at(i + 1).text;
                i += 2;
            } else if (at(i).text == "[") {
                const size_t end = behind(i, "[", "]");
                for (; i < end; ++i) out += at(i).text;
            } else {
                return out;
            }
        }
    }

    std::string file_;
    const TextScanner* scanner_;
    const std::vector<Token>* tokens_;
    const Kind* kind_;
    std::map<std::string, size_t> structs_, functions_;  ///< where members, and a function's type, begin
    std::vector<std::string> order_, function_order_;
    std::map<std::string, std::string> bodies_;
    std::set<std::string> under_way_;
};

constexpr const char* of_slope = R"(
Slope shape_slope(Shape s, Terms t) {
    slope_own_Shape p;
    for (int i = 0; i < SHAPE_COUNT; ++i) {
        p.x[i] = slope_number(s.x[i]);
        p.x[i].d[i] = 1.0;
    }
    slope_own_Terms u;
    for (int k = 0; k < TERM_COUNT; ++k) u.x[k] = slope_number(t.x[k]);
    slope_own_Basis b = slope_own_basis(p, u);
    Slope g;
    for (int l = 0; l < SHAPED_COUNT; ++l)
        for (int i = 0; i < SHAPE_COUNT; ++i)
            g.x[l * SHAPE_COUNT + i] = b.x[BASIS_COUNT - SHAPED_COUNT + l].d[i];
    return g;
}
)";

constexpr const char* of_bend = R"(
struct Bends { vec2 x[SHAPED_COUNT]; };
Bends shape_bends(Shape s, Shape d, Terms t) {
    bend_own_Shape p;
    for (int i = 0; i < SHAPE_COUNT; ++i) p.x[i] = bend_real(s.x[i], d.x[i], 0.0);
    bend_own_Terms u;
    for (int k = 0; k < TERM_COUNT; ++k) u.x[k] = bend_number(t.x[k]);
    bend_own_Basis b = bend_own_basis(p, u);
    Bends along;
    for (int l = 0; l < SHAPED_COUNT; ++l) {
        bend_real x = b.x[BASIS_COUNT - SHAPED_COUNT + l];
        along.x[l] = vec2(x.d, x.e);
    }
    return along;
}
vec2 shape_bend(Shape s, Shape d, Terms t) { return shape_bends(s, d, t).x[0]; }
)";

}  // namespace

std::string with_derivatives(const std::string& file, const std::string& text, int shaped,
                             const std::function<std::string(const std::string&)>& read) {
    TextScanner scanner(file, read);
    scanner.scan(text);
    if (scanner.value_of("SHAPE_COUNT") == "0" ||
        (scanner.has_function("shape_slope") && scanner.has_function("shape_bend")))
        return text;
    if (const auto& [where, line, what] = scanner.first_unknown(); line > 0) refuse_text(where, line, what);
    if (scanner.value_of("SHAPE_COUNT").empty()) refuse_text(file, 1, "no SHAPE_COUNT is defined");
    std::string out = text;
    const auto add = [&](const Kind& kind, const char* function, const char* made) {
        if (scanner.has_function(function)) return;
        Translator translator(file, scanner, kind);
        if (shaped > 1 && translator.has_struct("Slope"))
            refuse_text(file, 1,
                        "a struct Slope where SHAPED_COUNT is above 1: leave it out, since derivatives are made");
        if (!translator.has_struct("Slope") && &kind == &slope)
            out += "struct Slope { float x[SHAPED_COUNT * SHAPE_COUNT]; };\n";
        out += translator.translated() + made;
    };
    if (!out.ends_with('\n')) out += '\n';
    // by its value: it may be an expression, or stand where C++ alone reads it
    if (scanner.defines("SHAPED_COUNT")) out += "#undef SHAPED_COUNT\n";
    out += fmt::format("#define SHAPED_COUNT {}\n", shaped);
    add(slope, "shape_slope", of_slope);
    add(bend, "shape_bend", of_bend);
    return out;
}

}  // namespace radiafit
