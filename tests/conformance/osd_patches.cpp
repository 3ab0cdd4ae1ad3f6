#include "conformance/osd_patches.h"

#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/stencilTable.h>

#include "conformance/osd_refiner.h"

namespace osd = OpenSubdiv;

namespace limn::test {
namespace {

struct Point {
    Vector3 at{};
    void Clear() { at = {}; }
    void AddWithWeight(const Point& source, double weight) {
        for (size_t i = 0; i < 3; ++i) at[i] += weight * source.at[i];
    }
};

// Control points, the points of all levels after them, and the local points of the end caps.
std::vector<Point> make_points(const TestMesh& mesh, const osd::Far::TopologyRefiner& refiner,
                               const osd::Far::PatchTable& table) {
    std::vector<Point> points(static_cast<size_t>(refiner.GetNumVerticesTotal() + table.GetNumLocalPoints()));
    for (size_t i = 0; i < mesh.positions.size(); ++i)
        points[i / 3].at[i % 3] = static_cast<double>(mesh.positions[i]);
    const osd::Far::PrimvarRefinerReal<double> primvar(refiner);
    Point* source = points.data();
    for (int level = 1; level <= refiner.GetMaxLevel(); ++level) {
        Point* target = source + refiner.GetLevel(level - 1).GetNumVertices();
        primvar.Interpolate(level, source, target);
        source = target;
    }
    if (table.GetNumLocalPoints() != 0)
        table.GetLocalPointStencilTable<double>()->UpdateValues(
            points.data(), points.data() + refiner.GetNumVerticesTotal());
    return points;
}

}  // namespace

struct OsdPatches::Data {
    std::unique_ptr<osd::Far::TopologyRefiner> refiner;
    std::unique_ptr<const osd::Far::PatchTable> table;
    std::vector<osd::Far::PatchTable::PatchHandle> handles;
};

OsdPatches::OsdPatches() : data_(std::make_unique<Data>()) {}
OsdPatches::~OsdPatches() = default;

std::unique_ptr<OsdPatches> OsdPatches::create(const TestMesh& mesh, uint32_t isolation_level,
                                               std::string* error) {
    using Factory = osd::Far::PatchTableFactory;
    std::unique_ptr<OsdPatches> result(new OsdPatches);
    Data& data = *result->data_;
    data.refiner = make_osd_refiner(mesh, error);
    if (!data.refiner) return nullptr;
    Factory::Options options(isolation_level);
    options.useInfSharpPatch = true;
    options.generateLegacySharpCornerPatches = false;
    options.SetEndCapType(Factory::Options::ENDCAP_GREGORY_BASIS);
    // Shared, points that are wrong in one patch would be so in its neighbours.
    options.shareEndCapPatchPoints = false;
    options.SetPatchPrecision<double>();
    data.refiner->RefineAdaptive(options.GetRefineAdaptiveOptions());
    data.table.reset(Factory::Create(*data.refiner, options));
    const std::vector<Point> points = make_points(mesh, *data.refiner, *data.table);
    int first = 0;
    for (int array = 0; array < data.table->GetNumPatchArrays(); ++array) {
        const auto type = data.table->GetPatchArrayDescriptor(array).GetType();
        const int count = data.table->GetNumPatches(array);
        const bool triangle = type == osd::Far::PatchDescriptor::GREGORY_TRIANGLE;
        if (triangle || type == osd::Far::PatchDescriptor::GREGORY_BASIS) {
            for (int p = 0; p < count; ++p) {
                const osd::Far::PatchParam param = data.table->GetPatchParam(array, p);
                const osd::Far::ConstIndexArray indices = data.table->GetPatchVertices(array, p);
                GregoryPatch patch{static_cast<uint32_t>(param.GetFaceId()),
                                   static_cast<uint32_t>(param.GetDepth()),
                                   {},
                                   {}};
                patch.corners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
                if (triangle) patch.corners = {{{0, 0}, {1, 0}, {0, 1}, {0, 0}}};
                for (auto& corner : patch.corners) {
                    if (triangle)
                        param.UnnormalizeTriangle(corner[0], corner[1]);
                    else
                        param.Unnormalize(corner[0], corner[1]);
                }
                for (int k = 0; k < indices.size(); ++k)
                    patch.points.push_back(points[static_cast<size_t>(indices[k])].at);
                result->patches_.push_back(std::move(patch));
                data.handles.emplace_back();
                data.handles.back().arrayIndex = array;
                data.handles.back().patchIndex = first + p;
                data.handles.back().vertIndex = p * indices.size();
            }
        }
        first += count;
    }
    return result;
}

std::array<Vector3, 6> OsdPatches::evaluate(size_t patch, double u, double v) const {
    std::array<std::array<double, 20>, 6> weights{};
    data_->table->EvaluateBasis(data_->handles[patch], u, v, weights[0].data(), weights[1].data(),
                                weights[2].data(), weights[3].data(), weights[4].data(), weights[5].data());
    std::array<Vector3, 6> result{};
    const std::vector<Vector3>& points = patches_[patch].points;
    for (size_t d = 0; d < 6; ++d)
        for (size_t k = 0; k < points.size(); ++k)
            for (size_t i = 0; i < 3; ++i) result[d][i] += weights[d][k] * points[k][i];
    return result;
}

}  // namespace limn::test
