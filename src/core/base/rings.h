#pragma once

/// The rings of the program, from the inside out; each is a namespace, in which names of the rings within it are
/// visible. The core is `radiafit` itself. docs/architecture.md says what is in each.
namespace radiafit {
namespace fits {}
namespace harness {
using namespace fits;
}
namespace tools {
using namespace fits;
using namespace harness;
}  // namespace tools
}  // namespace radiafit
