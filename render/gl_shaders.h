// The shaders of GlRenderer: from trapezoids to differences of covered area.
//
// What is drawn is not coverage but its difference from each pixel to the one west of it, which is
// summed up along the rows afterwards. So only the pixels that a side runs through need be drawn,
// however large the area between two sides.
//
// Sides: a trapezoid is a strip of pixels along each of its two sides. Vertices are eight to a
// trapezoid: four to a side, the left one first.
// Points: a trapezoid of few pixels is one square that holds both sides, from one vertex.
//
// The vertex shaders pull the integers of their trapezoid, make them relative to the picture and
// cut them to it in double precision; the fragment shaders integrate the area of pixel and
// half-plane in closed form.
#pragma once

#include <string>

namespace trapeze {

std::string side_vertex_shader();
std::string side_fragment_shader();
std::string point_vertex_shader();
std::string point_fragment_shader();

}  // namespace trapeze
