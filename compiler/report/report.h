#pragma once
// Measures families: error against a reference and time on a device, member by member, and what follows from them.
//
// Time is that of the loop that shades minus the least time of the same loop around an empty body, over the points shaded:
// ns a pixel, of at least 30 dispatches of at least 2 ms. Minima rank, since a shared machine only ever adds.

#include "compiler/report/bench.h"
#include "compiler/report/metrics.h"

namespace kiln::report {

struct Timing {
    double min = 0, median = 0, p90 = 0;  // ns a pixel
    double baseline = 0;                  // ns a pixel, least, already taken off
    double jit_ms = 0;
    double dispatch_ms = 0;  // least
    unsigned repeats = 0;
    std::string scene;  // whose points were shaded
};

struct Measured {
    Metrics all, region, rest;                    // the last two where the scene has a region
    Metrics all_noise, region_noise, rest_noise;  // how far they may be off
    Timing timing;
    uint64_t spirv = 0, operations = 0;  // of the picture's shader
    uint64_t bytes = 0;                  // of what it reads
    Bytes picture, error_map;            // PNG
    bool front_relmse = false, front_max_rel = false;
    // bias is given by its size here
    double value(Metric metric) const;
    double noise(Metric metric) const;  // of the reference, and of what a member draws at random
};

struct FamilyReport {
    Family family;
    std::vector<std::vector<Measured>> scenes;  // by scene, by member
    std::vector<Measured> together;             // by member: means over the scenes, largest of maxRel and maxAbs, no pictures
    std::vector<Bytes> references;              // PNG a scene
    std::vector<double> standard_errors;        // a scene
    std::vector<Judged> judged;
    std::vector<std::string> remarks;
};

struct Report {
    DeviceInfo device;
    bool quick = false;
    std::vector<FamilyReport> families;
};

struct ReportOptions {
    std::vector<std::string> families;  // numbers or names; empty: all
    bool quick = false;
    // The folder of encode_bc.mjs and its package (compiler/bake/bc_encoder.h); empty: members in BC formats are left out, and
    // a remark says so.
    std::string bc_encoder;
};

using Progress = std::function<void(const char* what, size_t done, size_t total)>;

// Usage error: no such family. Ends early with an environment error when `interrupted` is set.
Result<Report> run_report(const ReportOptions& options, Library& library, Toolchain& tools, Bench& bench,
                          const Progress& progress);

Result<std::vector<Family>> chosen_families(const ReportOptions& options);

struct Timing times_of(const Timed& member, double baseline_ns, double pixels);

struct Budget {
    Metric metric = Metric::relmse;
    double limit = 0;
};
// "relmse=1e-3". Usage errors say what is known.
Result<Budget> parse_budget(const std::string& text);
// The cheapest member within all budgets, without a number that is not finite; nothing when there is none.
std::optional<size_t> cheapest(const FamilyReport& family, const std::vector<Budget>& budgets);
std::string budget_text(const Report& report, const std::vector<Budget>& budgets);

// The report as it is published.
std::string as_csv(const Report& report);
std::string as_html(const Report& report, const std::vector<Budget>& budgets);

}  // namespace kiln::report
