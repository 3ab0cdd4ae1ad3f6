// The passes of each scheme, a file each. Not part of the public interface.
#pragma once

#include <span>

#include "limn/schemes/subdivision_scheme.h"

namespace limn::schemes {

std::span<const Pass> catmull_clark_passes();
std::span<const Pass> loop_passes();
std::span<const Pass> bilinear_passes();
std::span<const Pass> linear_passes();  ///< triangles
std::span<const Pass> doo_sabin_passes();
std::span<const Pass> sqrt3_passes();
std::span<const Pass> averaging_passes(uint32_t degree);  ///< 2 to 9
std::span<const Pass> loop_warren_passes();
std::span<const Pass> butterfly_passes();
std::span<const Pass> butterfly_zorin_passes();
std::span<const Pass> sqrt3_interpolatory_passes();
std::span<const Pass> sqrt3_composite_passes(uint32_t count);  ///< 2 or 3
std::span<const Pass> four_eight_passes();
std::span<const Pass> sqrt2_balanced_passes();
std::span<const Pass> sqrt2_interpolatory_passes();
std::span<const Pass> honeycomb_passes();
std::span<const Pass> mid_edge_passes();
std::span<const Pass> midpoint_passes();
std::span<const Pass> midpoint_normalised_passes();
std::span<const Pass> stam_passes(uint32_t degree);           ///< 4 to 9
std::span<const Pass> stam_triangle_passes(uint32_t degree);  ///< 4, 7 or 10
std::span<const Pass> kobbelt_passes();
std::span<const Pass> sabin_passes();
std::span<const Pass> push_back_catmull_clark_passes();
std::span<const Pass> push_back_loop_passes();
std::span<const Pass> catmull_clark_blz_passes();
std::span<const Pass> loop_blz_passes();
std::span<const Pass> catmull_clark_g2_passes();
std::span<const Pass> loop_g2_passes();
std::span<const Pass> butterfly_g1_passes();
std::span<const Pass> nurss_passes();
std::span<const Pass> nurss_quadratic_passes();

// Masks that more than one scheme, or a scheme's patches, use.
/// What point i + j of an n-gon (n >= 2, j < n) weighs in the point of corner i that Doo-Sabin makes of it; j and n - j
/// weigh the same.
double doo_sabin_weight(uint32_t n, uint32_t j);
void doo_sabin_corner(const Topology& parent, uint32_t corner, Row& row);
void keep_vertex(const Stage& parent, uint32_t v, Row& row);
void face_centroid(const Stage& parent, uint32_t f, Row& row);
void edge_midpoint(const Stage& parent, uint32_t e, Row& row);
// Curves along boundaries, which end in fixed corners: Chaikin's corner cutting, cubic B-splines, the
// four-point scheme.
void chaikin_edge_end(const Stage& parent, uint32_t end, Row& row);
void cubic_boundary_vertex(const Stage& parent, uint32_t v, Row& row);
void four_point_boundary_edge(const Stage& parent, uint32_t e, Row& row);
void eight_point_edge(const Stage& parent, uint32_t e, Row& row);  ///< butterfly, inside; missing points reflected
void refined_vertex(const Stage& parent, uint32_t v, Row& row);  ///< Catmull-Clark's or Loop's
void refined_edge(const Stage& parent, uint32_t e, Row& row);

}  // namespace limn::schemes
