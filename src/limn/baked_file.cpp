#include "limn/baked_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include "limn/baked_check.h"
#include "limn/baked_format.h"
#include "limn/hash.h"

namespace limn {
namespace {

using Bytes = std::span<const std::byte>;

constexpr uint64_t kMostItems = 4096;  // of a list: channels, grids

uint64_t round_up(uint64_t bytes) {
    return (bytes + kBakedAlignment - 1) / kBakedAlignment * kBakedAlignment;
}

/// Notes what a file consists of, in order.
struct Writer {
    std::vector<uint64_t> values;
    std::vector<BakedArray> arrays;
    std::vector<Bytes> contents;

    void value(const auto& number, uint64_t) { values.push_back(static_cast<uint64_t>(number)); }
    template <class T>
    void array(const Array<T>& array) {
        arrays.push_back({0, array.size(), sizeof(T)});
        contents.push_back(std::as_bytes(std::span(array.data(), array.size())));
    }
    void list(const auto& items, const auto& body) {
        values.push_back(items.size());
        for (const auto& item : items) body(item);
    }
};

/// A file in pieces, with the header's checksum to be filled in.
struct FilePieces {
    Writer writer;
    BakedHeader header = {};

    explicit FilePieces(const BakedMesh& mesh) {
        visit_mesh(writer, mesh);
        std::memcpy(header.magic, kBakedMagic, sizeof kBakedMagic);
        header.byte_order = kBakedByteOrder;
        header.version = kBakedVersion;
        header.key[0] = mesh.key.high;
        header.key[1] = mesh.key.low;
        header.value_count = static_cast<uint32_t>(writer.values.size());
        header.array_count = static_cast<uint32_t>(writer.arrays.size());
        uint64_t end = round_up(sizeof header + 8 * writer.values.size() + sizeof(BakedArray) * writer.arrays.size());
        for (size_t i = 0; i < writer.arrays.size(); ++i) {
            writer.arrays[i].offset = end;
            end += round_up(writer.contents[i].size());
        }
        header.file_bytes = end;
        ContentHasher hash;
        each([&](Bytes piece) { hash.add_bytes(piece); }, kChecksumEnd);
        const ContentHash sum = hash.finish();
        header.checksum[0] = sum.high;
        header.checksum[1] = sum.low;
    }

    /// body(piece) from byte `skip` of the header to the end of the file.
    template <class Body>
    void each(const Body& body, size_t skip = 0) const {
        static constexpr std::byte kZeros[kBakedAlignment] = {};
        uint64_t at = 0;
        const auto put = [&](Bytes piece) {
            body(piece);
            at += piece.size();
        };
        const auto pad = [&] { put(Bytes(kZeros, round_up(at) - at)); };
        put(Bytes(std::as_bytes(std::span(&header, 1))).subspan(skip));
        at += skip;
        put(std::as_bytes(std::span(writer.values)));
        put(std::as_bytes(std::span(writer.arrays)));
        pad();
        for (const Bytes array : writer.contents) {
            put(array);
            pad();
        }
    }
};

/// Points the tables of a mesh into a file. After the first thing that does not fit it does nothing.
struct Reader {
    Bytes bytes;
    std::span<const uint64_t> values;
    std::span<const BakedArray> arrays;
    const char* error = nullptr;

    uint64_t next(uint64_t most) {
        if (error == nullptr && values.empty()) error = "its directory is cut short";
        if (error == nullptr && values[0] > most) error = "a number in its directory is out of range";
        if (error != nullptr) return 0;
        const uint64_t number = values[0];
        values = values.subspan(1);
        return number;
    }
    template <class T>
    void value(T& number, uint64_t most) {
        number = static_cast<T>(next(most));
    }
    template <class T>
    void array(Array<T>& array) {
        if (error == nullptr && arrays.empty()) error = "its directory is cut short";
        if (error != nullptr) return;
        const BakedArray entry = arrays[0];
        arrays = arrays.subspan(1);
        const bool fits = entry.element_bytes == sizeof(T) && entry.offset % kBakedAlignment == 0 &&
                          entry.offset <= bytes.size() && entry.count <= (bytes.size() - entry.offset) / sizeof(T);
        if (!fits)
            error = "an array does not lie within it";
        else
            array = Array<T>::borrow(reinterpret_cast<const T*>(bytes.data() + entry.offset), entry.count);
    }
    void list(auto& items, const auto& body) {
        items.resize(next(kMostItems));
        for (auto& item : items) body(item);
    }
};

Error refuse(const std::string& cause) {
    return {ErrorCode::parse_error, cause};
}

Result<BakedHeader> read_header(Bytes bytes) {
    if (bytes.empty()) return refuse("is empty");
    BakedHeader header = {};
    std::memcpy(&header, bytes.data(), std::min(bytes.size(), sizeof header));
    if (std::memcmp(header.magic, kBakedMagic, sizeof kBakedMagic) != 0) return refuse("is no baked file of limn");
    if (bytes.size() < sizeof header) return refuse("is cut short: " + std::to_string(bytes.size()) + " bytes");
    if (header.byte_order != kBakedByteOrder)
        return refuse(header.byte_order == 0x04030201 ? "was baked for the other byte order; bake it on this kind of machine"
                                                      : "has no byte order");
    if (header.version != kBakedVersion)
        return refuse("has format version " + std::to_string(header.version) + ", and this library reads version " +
                      std::to_string(kBakedVersion) + "; bake it again");
    if (header.file_bytes != bytes.size())
        return refuse("is cut short or damaged: " + std::to_string(bytes.size()) + " bytes of " +
                      std::to_string(header.file_bytes));
    const uint64_t directory = uint64_t{8} * header.value_count + sizeof(BakedArray) * uint64_t{header.array_count};
    if (directory > bytes.size() - sizeof header) return refuse("is damaged: its directory does not lie within it");
    return header;
}

Error name_file(const std::string& path, Error error) {
    error.message = printable(path) + ": " + error.message;
    return error;
}

struct Mapping {
    std::byte* memory = nullptr;
    size_t size = 0;
};

Result<Mapping> map_file(const std::string& path) {
    const auto failed = [&](const char* what, int code) {
        return Error{ErrorCode::cannot_open, printable(path) + ": " + what + ": " + std::generic_category().message(code)};
    };
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) return failed("cannot open", errno);
    struct stat status = {};
    Result<Mapping> out = Mapping{};
    if (fstat(file, &status) != 0) {
        out = failed("cannot read", errno);
    } else if (!S_ISREG(status.st_mode)) {
        out = failed("cannot read", S_ISDIR(status.st_mode) ? EISDIR : EINVAL);
    } else if (status.st_size == 0) {
        out = Error{ErrorCode::parse_error, printable(path) + ": is empty"};
    } else {
        const auto size = static_cast<size_t>(status.st_size);
        int flags = MAP_PRIVATE;
#ifdef MAP_POPULATE
        flags |= MAP_POPULATE;  // all page faults at once
#endif
        void* memory = mmap(nullptr, size, PROT_READ, flags, file, 0);
        if (memory == MAP_FAILED)
            out = failed("cannot map", errno);
        else
            out = Mapping{static_cast<std::byte*>(memory), size};
    }
    ::close(file);
    return out;
}

}  // namespace

Result<void> write_baked_file(const std::string& path, const BakedMesh& mesh) {
    auto file = FileWriter::create(path);
    if (!file) return file.error();
    const FilePieces pieces(mesh);
    pieces.each([&](Bytes piece) {
        while (!piece.empty()) {
            const Bytes part = piece.first(std::min(piece.size(), FileWriter::kBufferBytes));
            file->append({reinterpret_cast<const char*>(part.data()), part.size()});
            piece = piece.subspan(part.size());
        }
    });
    return file->commit();
}

Array<std::byte> write_baked_bytes(const BakedMesh& mesh) {
    const FilePieces pieces(mesh);
    Array<std::byte> out;
    out.allocate(pieces.header.file_bytes);
    std::byte* to = out.data();
    pieces.each([&](Bytes piece) {
        if (!piece.empty()) std::memcpy(to, piece.data(), piece.size());
        to += piece.size();
    });
    return out;
}

Result<BakedMesh> load_baked_bytes(Bytes bytes, const BakedLoadOptions& options) {
    if (reinterpret_cast<uintptr_t>(bytes.data()) % 16 != 0)
        return Error{ErrorCode::invalid_argument, "baked bytes do not begin at a multiple of 16"};
    const auto header = read_header(bytes);
    if (!header) return header.error();
    if (options.check_sums) {
        ContentHasher hash;
        hash.add_bytes(bytes.subspan(kChecksumEnd));
        if (hash.finish() != ContentHash{header->checksum[0], header->checksum[1]})
            return refuse("is damaged: its checksum is another");
    }
    const std::byte* directory = bytes.data() + sizeof(BakedHeader);
    Reader reader{bytes,
                  {reinterpret_cast<const uint64_t*>(directory), header->value_count},
                  {reinterpret_cast<const BakedArray*>(directory + size_t{8} * header->value_count), header->array_count}};
    BakedMesh mesh;
    mesh.key = {header->key[0], header->key[1]};
    visit_mesh(reader, mesh);
    if (reader.error == nullptr && !(reader.values.empty() && reader.arrays.empty()))
        reader.error = "its directory says more than there is";
    if (reader.error != nullptr) return refuse(std::string("is damaged: ") + reader.error);
    if (options.check_contents)
        if (auto checked = check_baked_mesh(mesh); !checked) return checked.error();
    return mesh;
}

void BakedFile::Unmap::operator()(std::byte* memory) const {
    munmap(memory, size);
}

Result<BakedFile> BakedFile::open(const std::string& path, const BakedLoadOptions& options) {
    BakedFile out;
    if (options.map) {
        const auto mapping = map_file(path);
        if (!mapping) return mapping.error();
        out.mapping_ = {mapping->memory, {mapping->size}};
        out.bytes_ = {mapping->memory, mapping->size};
    } else {
        auto copy = read_file(path);
        if (!copy) return copy.error();
        out.copy_ = std::move(*copy);
        out.bytes_ = std::as_bytes(std::span(out.copy_.data.get(), out.copy_.size));
    }
    auto mesh = load_baked_bytes(out.bytes_, options);
    if (!mesh) return name_file(path, mesh.error());
    out.mesh_ = std::move(*mesh);
    return out;
}

bool is_baked_file(const std::string& path) {
    struct stat status = {};  // not from a pipe, which would have lost what was read
    if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return false;
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (file == nullptr) return false;
    char magic[sizeof kBakedMagic] = {};
    const size_t count = std::fread(magic, 1, sizeof magic, file);
    std::fclose(file);
    return count == sizeof magic && std::memcmp(magic, kBakedMagic, sizeof magic) == 0;
}

Result<BakedFile> load_or_bake(const std::string& directory, const ControlMeshDescription& description,
                               const BakeOptions& options, const BakedLoadOptions& load) {
    const ContentHash key = content_hash(description, options);
    const std::string path = directory + "/" + key.hex() + ".limn";
    if (auto known = BakedFile::open(path, load); known && known->mesh().key == key) return known;
    const auto mesh = bake_mesh(description, options);
    if (!mesh) return mesh.error();
    if (auto written = write_baked_file(path, *mesh); !written) return written.error();
    return BakedFile::open(path, load);
}

}  // namespace limn
