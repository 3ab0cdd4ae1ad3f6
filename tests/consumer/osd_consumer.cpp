// Takes stencils of OpenSubdiv's for a tetrahedron to limn's form, with limn::osd.
#include <cstdio>
#include <limn/osd/far_tables.h>
#include <memory>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>

namespace Far = OpenSubdiv::Far;

int main() {
    const int face_sizes[] = {3, 3, 3, 3};
    const Far::Index face_vertices[] = {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0};
    Far::TopologyDescriptor description;
    description.numVertices = 4;
    description.numFaces = 4;
    description.numVertsPerFace = face_sizes;
    description.vertIndicesPerFace = face_vertices;
    const std::unique_ptr<Far::TopologyRefiner> refiner(
        Far::TopologyRefinerFactory<Far::TopologyDescriptor>::Create(description, {}));
    refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(1));
    const std::unique_ptr<const Far::StencilTable> stencils(Far::StencilTableFactory::Create(*refiner));
    const auto table = limn::osd::convert_stencil_table(*stencils);
    if (!table) return std::puts(table.error().message.c_str()), 1;
    std::printf("%u points of level 1\n", table->row_count());
    return table->row_count() == 14 ? 0 : 1;
}
