// Baked files: what a mesh needs at run time, in a file that is mapped and pointed into. Nothing is parsed or copied.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "limn/baked_mesh.h"
#include "limn/file.h"

namespace limn {

/// Writes a file; its name should end in .limn. It appears under its name once it is complete. Errors: cannot_open,
/// out_of_memory, as FileWriter.
Result<void> write_baked_file(const std::string& path, const BakedMesh& mesh);

/// The same bytes, in memory.
Array<std::byte> write_baked_bytes(const BakedMesh& mesh);

struct BakedLoadOptions {
    /// False trusts the file: one that was damaged or made to do harm then crashes this process or hangs the device.
    bool check_sums = true;
    bool check_contents = true;
    /// False reads the file into memory: for files that others may write into while they are open here, rather than
    /// replace them as write_baked_file does.
    bool map = true;
};

/// A baked mesh whose tables lie in a mapped file, for as long as this lives. Moving it does not move them.
class BakedFile {
  public:
    /// Maps the file, checks it, points into it. Every count, offset, index and weight that evaluation or a device
    /// would follow is checked, in time linear in the file, on all cores: a file that loads is safe to use.
    /// Errors: cannot_open (missing, a directory, empty, unreadable); parse_error (no baked file, of another version
    /// or byte order, cut short, damaged, or with contents that do not fit together). Messages are `PATH: cause`.
    static Result<BakedFile> open(const std::string& path, const BakedLoadOptions& options = {});

    const BakedMesh& mesh() const { return mesh_; }
    uint64_t bytes() const { return bytes_.size(); }

  private:
    struct Unmap {
        size_t size;
        void operator()(std::byte* memory) const;
    };
    std::unique_ptr<std::byte, Unmap> mapping_;
    FileBytes copy_;
    std::span<const std::byte> bytes_;
    BakedMesh mesh_;
};

/// Tables that lie in `bytes`, which begin at a multiple of 16, live longer than the tables and do not change. Errors:
/// as BakedFile::open; invalid_argument (where they begin).
Result<BakedMesh> load_baked_bytes(std::span<const std::byte> bytes, const BakedLoadOptions& options = {});

/// Whether the file begins as baked files do. False where it cannot be read.
bool is_baked_file(const std::string& path);

/// The baked mesh of these: `directory`/KEY.limn where there is one that loads and has the key, else it is baked and
/// written there first. Any number of threads and processes may share a directory. Errors: as bake_mesh,
/// write_baked_file and BakedFile::open.
Result<BakedFile> load_or_bake(const std::string& directory, const ControlMeshDescription& description,
                               const BakeOptions& options, const BakedLoadOptions& load = {});

}  // namespace limn
