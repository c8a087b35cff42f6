// The command line: a table of verbs, one exit, one signal handler. A stop by Ctrl-C sets a flag that every long loop watches;
// files are only ever published whole, so nothing half-written is left; the process then ends by the signal, as make expects.
#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstring>

#include "compiler/base/jobs.h"
#include "compiler/pass.h"
#include "tools/console.h"
#include "tools/environment.h"
#include "tools/verbs.h"

namespace {

volatile std::sig_atomic_t caught = 0;

void on_signal(int signal) {
    if (caught != 0) {  // asked twice: do not wait
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
    caught = signal;
    kiln::interrupted.store(true);
}

// `helped`: after "help", which knows a word more.
int no_verb(const std::vector<kiln::Verb>& verbs, const std::string& word, bool helped) {
    std::vector<std::string> names;
    for (const kiln::Verb& verb : verbs)
        if (!verb.hidden) names.emplace_back(verb.name);
    if (helped) names.emplace_back("environment");
    const std::string near = kiln::nearest(word, names);
    return kiln::print_error(
        {kiln::Fault::usage,
         "no verb '" + word + "'" + (near.empty() ? "; kiln --help lists them" : "; did you mean '" + near + "'?")});
}

// A program started with a standard stream closed would get that number for the first file it opens, and then print into it.
// The stand-ins are opened the wrong way round, so that using them still fails as a closed stream does.
void hold_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) != -1) continue;
        const int held = ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
        if (held >= 0 && held != stream) ::close(held);
    }
}

int dispatch(const std::vector<kiln::Verb>& verbs, const std::vector<std::string>& words) {
    using namespace kiln;
    if (words.empty()) return print_error({Fault::usage, "what to do? kiln --help lists the verbs"});
    if (words[0] == "--help" || words[0] == "-h" || words[0] == "help") {
        for (const Verb& verb : verbs)
            if (words.size() > 1 && words[1] == verb.name) return finish(help_of(verb));
        if (words.size() > 1 && words[1] == "environment") return finish(help_of_environment());
        if (words.size() == 1 || words[0] != "help") return finish(help_of(verbs));
        return no_verb(verbs, words[1], true);
    }
    if (words[0] == "--version") return finish(std::string("kiln ") + kiln_version + "\n" + make_toolchain()->versions() + "\n");
    for (const Verb& verb : verbs) {
        if (words[0] != verb.name) continue;
        const std::vector<std::string> rest(words.begin() + 1, words.end());
        for (const std::string& word : rest) {
            if (word == "--") break;
            if (word == "--help" || word == "-h") return finish(help_of(verb));
        }
        const auto args = Args::parse(verb, rest);
        if (!args.ok()) return print_error(args.error());
        return verb.run(*args);
    }
    return no_verb(verbs, words[0], false);
}

}  // namespace

int main(int argc, char** argv) {
    hold_standard_streams();
    struct sigaction action {};
    action.sa_handler = on_signal;
    sigemptyset(&action.sa_mask);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
    std::signal(SIGPIPE, SIG_IGN);

    const std::vector<kiln::Verb> verbs{kiln::verb_count,      kiln::verb_build, kiln::verb_validate,       kiln::verb_explain,
                                        kiln::verb_preprocess, kiln::verb_dump,  kiln::verb_diff,           kiln::verb_sheet,
                                        kiln::verb_report,     kiln::verb_cache, kiln::verb_validate_worker};
    const int code = dispatch(verbs, std::vector<std::string>(argv + 1, argv + argc));
    kiln::clear_progress();
    if (caught != 0) {
        const int signal = caught;
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
    return code;
}
