// Runs the program as scripts do.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace limn {

struct Outcome {
    int status = -1;
    std::string output, errors;
};

/// A folder with cube.obj, to run the program in.
class Program : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (std::filesystem::temp_directory_path() / "limn_program_XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
        write("cube.obj", kCube);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
    std::string read(const std::string& name) const {
        std::ifstream in(path(name));
        return {std::istreambuf_iterator<char>(in), {}};
    }

    Outcome run(const std::string& arguments, const std::string& input = "/dev/null") const {
        return run_command(LIMN_PROGRAM " " + arguments, input);
    }
    Outcome run_command(const std::string& command, const std::string& input) const {
        const std::string line = "cd '" + folder_.string() + "' && " + command + " >out.txt 2>err.txt <" + input;
        const int status = std::system(line.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("out.txt"), read("err.txt")};
    }

    /// limn view, on a display of its own.
    static bool has_display() { return std::system("command -v xvfb-run xauth >/dev/null") == 0; }
    static constexpr const char* kNoDisplay =
        "xvfb-run or xauth is not installed (Debian: xvfb xauth): limn view is not tested";
    Outcome show(const std::string& arguments) const {
        return run_command("xvfb-run -a -s '-screen 0 800x600x24' " LIMN_PROGRAM " view " + arguments, "/dev/null");
    }

    /// Fails with this status, one line on standard error that holds `cause`, and writes no file.
    void expect_failure(const std::string& arguments, int status, const std::string& cause) const {
        SCOPED_TRACE(arguments);
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.status, status);
        EXPECT_NE(outcome.errors.find(cause), std::string::npos) << outcome.errors;
        if (status != 2) {  // usage errors point to --help in a second line
            EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
        }
        for (const auto& entry : std::filesystem::directory_iterator(folder_))
            EXPECT_EQ(entry.path().filename().string().rfind("result", 0), std::string::npos) << entry.path();
    }

    static constexpr const char* kCube =
        "v -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 -1\nv 1 -1 -1\n"
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "f 1/1 2/2 4/3 3/4\nf 3/1 4/2 6/3 5/4\nf 5/1 6/2 8/3 7/4\nf 7/1 8/2 2/3 1/4\nf 2/1 8/2 6/3 4/4\n"
        "f 7/1 1/2 3/3 5/4\nt crease 2/1/0 0 1 2.5\n";
    std::filesystem::path folder_;
};

}  // namespace limn
