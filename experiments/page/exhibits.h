#pragma once
#include <span>
#include <vector>

namespace radiafit::harness {

/// What the report shows of one experiment, and what our text of the paper says of the same.
struct Exhibit {
    const char* experiment;
    const char* title;
    const char* section;  ///< of the paper; empty: the paper has nothing like it
    const char* paper;    ///< what it states there, or that our text has lost it
    const char* shows;    ///< what is to be seen in the figure, for who cannot see it; empty: there is no figure
    const char* command;  ///< that makes the rows; PROFILE stands for the profile's name
    /// Files of the run that are shown as tables: its own NAME.md, or rows of which each is worth reading.
    std::vector<const char*> tables;
};

/// The paper's own table and figures first.
std::span<const Exhibit> exhibits();

}  // namespace radiafit::harness
