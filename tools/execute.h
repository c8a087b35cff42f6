#pragma once
// --execute ENGINE: opens an engine and what hands a pass's work to it; --distributed-plan: what that would send.

#include <memory>

#include "compiler/pass.h"
#include "tools/args.h"
#include "tools/distribute.h"
#include "tools/json.h"

namespace kiln {

extern const Option option_execute, option_execute_timeout, option_plan, option_workers;

struct Execution {
    std::unique_ptr<Engine> engine;
    std::unique_ptr<Distributor> distributor;

    // nullptr without --execute. The worker's program lies beside kiln's own, or where $KILN_WORKER says.
    static Result<std::unique_ptr<Execution>> open(const Args& args, Store& store, Toolchain& tools);
};

// Nodes of the Remote Execution API, taken in turn. Settings come from the environment: KILN_EXECUTE_TOKEN_FILE, KILN_EXECUTE_CA
// (PEM, for grpcs), KILN_EXECUTE_PLATFORM (NAME=VALUE,… that workers must have).
Result<std::unique_ptr<Engine>> open_nodes(const std::vector<std::string>& addresses);

void execution_json(Json& json, const Execution& execution);
std::string execution_text(const Execution& execution);
// What went wrong, in a line; empty when nothing did.
std::string execution_warning(const Execution& execution);

// Builds at home with an empty cache, to know what there is to send and what it takes, and writes no table. The exit code.
int print_plan(const Args& args, const BuildOptions& options, PassContext& context);

}  // namespace kiln
