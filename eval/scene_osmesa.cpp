// SPDX-License-Identifier: BSD-3-Clause
// The sole owner of OSMesa: pictures with neither display nor graphics card.
#define GL_GLEXT_PROTOTYPES
#include "base/error.h"
#include "base/parallel.h"
#include "eval/scene.h"

#include <GL/gl.h>
#include <GL/glext.h>
#include <GL/osmesa.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>

namespace adit {

namespace {

// Both begin with the version and, for dots, `#define DOTS`: where a shader may discard, Mesa shades what lies hidden too.
const char* vertex_shader = R"(
layout(location = 0) in vec3 p;
layout(location = 1) in vec3 n;
layout(location = 2) in vec4 c;
uniform mat4 X_CW;
uniform mat4 projection;
uniform float dot_px, least_px;  // dot size in pixels at depth 1 (perspective) or everywhere
uniform bool perspective;
out vec3 p_W, p_C, n_W;
out vec4 tint;
void main() {
  vec4 at = X_CW * vec4(p, 1.0);
  p_W = p;
  p_C = at.xyz;
  n_W = n;
  tint = c;
  gl_Position = projection * at;
  gl_PointSize = max(least_px, perspective ? dot_px / max(0.01, -at.z) : dot_px);
})";

const char* fragment_shader = R"(
in vec3 p_W, p_C, n_W;
in vec4 tint;
uniform vec3 eye, forward;
uniform bool perspective, headlamp;
uniform float rock, gloss, lamp;
out vec4 colour;

float hash(vec3 p) {
  uvec3 q = uvec3(ivec3(floor(p))) * uvec3(1597334673u, 3812015801u, 2798796415u);
  uint n = (q.x ^ q.y ^ q.z) * 1597334673u;
  n ^= n >> 15; n *= 2246822519u; n ^= n >> 13;
  return float(n >> 8) / 16777216.0;
}
// Slope and value of a smooth noise.
vec4 noise(vec3 p) {
  vec3 i = floor(p), f = p - i, s = f * f * (3.0 - 2.0 * f), ds = 6.0 * f * (1.0 - f);
  float a = hash(i), b = hash(i + vec3(1, 0, 0)), c = hash(i + vec3(0, 1, 0)), d = hash(i + vec3(1, 1, 0)),
        e = hash(i + vec3(0, 0, 1)), g = hash(i + vec3(1, 0, 1)), h = hash(i + vec3(0, 1, 1)), k = hash(i + vec3(1, 1, 1));
  float x = b - a, y = c - a, z = e - a, xy = a - b - c + d, yz = a - c - e + h, zx = a - b - e + g,
        xyz = b + c - a - d + e - g - h + k;
  return vec4(ds * vec3(x + xy * s.y + zx * s.z + xyz * s.y * s.z, y + yz * s.z + xy * s.x + xyz * s.z * s.x,
                        z + zx * s.x + yz * s.y + xyz * s.x * s.y),
              a + x * s.x + y * s.y + z * s.z + xy * s.x * s.y + yz * s.y * s.z + zx * s.z * s.x + xyz * s.x * s.y * s.z);
}
// Of the finest the slope is that over 3 cm.
vec4 grain(vec3 p) {
  vec4 wide = noise(2.3 * p), mean = noise(5.1 * p + 7.0), fine = noise(14.0 * p + 31.0);
  return vec4(0.45 * 2.3 * wide.xyz + 0.3 * 5.1 * mean.xyz + 0.25 * 14.0 * 0.8 * fine.xyz,
              0.45 * wide.w + 0.3 * mean.w + 0.25 * fine.w);
}

void main() {
#ifdef DOTS
  vec2 d = 2.0 * gl_PointCoord - 1.0;
  if (dot(d, d) > 1.0) discard;
#endif
  vec3 to_eye = perspective ? normalize(eye - p_W) : -forward;
  float light = 1.0;
  vec3 base = tint.rgb;
  float distance_m = length(p_C);
#ifndef DOTS
  vec3 n = normalize(n_W);
  if (rock > 0.0) {
    vec4 g = grain(p_W);
    float near = 1.0 / (1.0 + 0.02 * distance_m * distance_m);
    n = normalize(n - rock * near * 0.10 * (g.xyz - n * dot(g.xyz, n)));
    base *= mix(1.0, 0.62 + 0.76 * g.w, rock);
  }
  if (dot(n, to_eye) < 0.0) n = -n;
  float head = dot(n, to_eye);
  base = mix(base, vec3(0.30, 0.33, 0.35), gloss * pow(1.0 - head, 4.0));  // what still water mirrors at a low angle
  if (headlamp) {
    light = 0.25 + 0.75 * pow(head, 0.8);
  } else {
    float sky = 0.5 + 0.5 * n.z;
    float key = max(0.0, dot(n, normalize(vec3(-0.5, -0.35, 0.8))));
    light = 0.40 + 0.24 * sky + 0.22 * key + 0.24 * head;
  }
#endif
  if (headlamp) light *= mix(1.2, 1.8, rock) / (1.0 + pow(distance_m / lamp, 1.6));
  colour = vec4(min(base * light, vec3(1.0)), 1.0);
})";

// One context for the process: making one compiles the shaders, and Mesa's is not for two threads at once.
class Stage {
 public:
  static Stage& the() {
    static Stage stage;
    return stage;
  }
  std::mutex mutex;

  // Colour and depth buffers of width x height, cleared; row 0 at the bottom.
  void open(int width, int height, Colour background) {
    buffer.assign(static_cast<size_t>(width) * height, Colour{});
    if (!OSMesaMakeCurrent(context_, buffer.data(), GL_UNSIGNED_BYTE, width, height))
      throw Error("pictures: OSMesa gives no picture of " + std::to_string(width) + " x " + std::to_string(height));
    if (program_[0] == 0)
      for (const bool dots : {false, true}) program_[dots] = linked(dots ? "#define DOTS" : "");
    glViewport(0, 0, width, height);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_PROGRAM_POINT_SIZE);
    glClearColor(background.r / 255.f, background.g / 255.f, background.b / 255.f, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  }
  void use(bool dots) {
    used_ = program_[dots];
    glUseProgram(used_);
  }
  GLint uniform(const char* name) const { return glGetUniformLocation(used_, name); }

  std::vector<Colour> buffer;

 private:
  Stage() {
    const int attributes[] = {OSMESA_FORMAT,
                              OSMESA_RGBA,
                              OSMESA_DEPTH_BITS,
                              32,
                              OSMESA_PROFILE,
                              OSMESA_CORE_PROFILE,
                              OSMESA_CONTEXT_MAJOR_VERSION,
                              3,
                              OSMESA_CONTEXT_MINOR_VERSION,
                              3,
                              0};
    context_ = OSMesaCreateContextAttribs(attributes, nullptr);
    if (!context_) throw Error("pictures: OSMesa cannot be started (package libosmesa6)", Fault::file);
  }
  ~Stage() { OSMesaDestroyContext(context_); }

  static GLuint compile(GLenum kind, const char* defined, const char* body) {
    const GLuint shader = glCreateShader(kind);
    const char* source[] = {"#version 330 core\n", defined, body};
    glShaderSource(shader, 3, source, nullptr);
    glCompileShader(shader);
    GLint good = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    if (!good) {
      std::string text(2000, ' ');
      glGetShaderInfoLog(shader, 2000, nullptr, text.data());
      throw Error("pictures: shader: " + text);
    }
    return shader;
  }
  static GLuint linked(const char* defined) {
    const GLuint program = glCreateProgram();
    glAttachShader(program, compile(GL_VERTEX_SHADER, defined, vertex_shader));
    glAttachShader(program, compile(GL_FRAGMENT_SHADER, defined, fragment_shader));
    glLinkProgram(program);
    GLint good = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &good);
    ADIT_CHECK(good);
    return program;
  }

  OSMesaContext context_ = nullptr;
  std::array<GLuint, 2> program_ = {};  // of faces, of dots
  GLuint used_ = 0;
};

// Vertex arrays that live as long as one drawing.
class Arrays {
 public:
  Arrays() {
    glGenVertexArrays(1, &array_);
    glBindVertexArray(array_);
  }
  ~Arrays() {
    glDeleteBuffers(static_cast<GLsizei>(buffers_.size()), buffers_.data());
    glDeleteVertexArrays(1, &array_);
  }
  Arrays(const Arrays&) = delete;
  Arrays& operator=(const Arrays&) = delete;

  template <class T>
  void fill(GLenum target, const std::vector<T>& values) {
    GLuint buffer = 0;
    glGenBuffers(1, &buffer);
    buffers_.push_back(buffer);
    glBindBuffer(target, buffer);
    glBufferData(target, static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data(), GL_STREAM_DRAW);
  }
  void vectors(GLuint slot, const std::vector<Eigen::Vector3f>& values) {
    fill(GL_ARRAY_BUFFER, values);
    glEnableVertexAttribArray(slot);
    glVertexAttribPointer(slot, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  }
  void colours(GLuint slot, const std::vector<Colour>& values) {
    fill(GL_ARRAY_BUFFER, values);
    glEnableVertexAttribArray(slot);
    glVertexAttribPointer(slot, 4, GL_UNSIGNED_BYTE, GL_TRUE, 0, nullptr);
  }

 private:
  GLuint array_ = 0;
  std::vector<GLuint> buffers_;
};

Eigen::Matrix4f view_of(const Camera& camera) {
  const Vec3 forward = (camera.target - camera.eye).normalized();
  const Vec3 right = forward.cross(camera.up).normalized(), above = right.cross(forward);
  Eigen::Matrix4d X = Eigen::Matrix4d::Identity();
  X.row(0).head<3>() = right.transpose();
  X.row(1).head<3>() = above.transpose();
  X.row(2).head<3>() = -forward.transpose();
  X.topRightCorner<3, 1>() = -X.topLeftCorner<3, 3>() * camera.eye;
  return X.cast<float>();
}

Eigen::Matrix4f projection_of(const Camera& camera, double aspect) {
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
  const double n = camera.near_m, f = camera.far_m;
  if (camera.fov_rad > 0) {
    const double cot = 1 / std::tan(camera.fov_rad / 2);
    P(0, 0) = cot / aspect;
    P(1, 1) = cot;
    P(2, 2) = (f + n) / (n - f);
    P(2, 3) = 2 * f * n / (n - f);
    P(3, 2) = -1;
  } else {
    P(0, 0) = 2 / (camera.height_m * aspect);
    P(1, 1) = 2 / camera.height_m;
    P(2, 2) = 2 / (n - f);
    P(2, 3) = (f + n) / (n - f);
    P(3, 3) = 1;
  }
  return P.cast<float>();
}

void set_look(const Stage& stage, const Scene& scene, const Camera& camera, double aspect) {
  const Eigen::Matrix4f view = view_of(camera), projection = projection_of(camera, aspect);
  const Eigen::Vector3f eye = camera.eye.cast<float>(),
                        forward = (camera.target - camera.eye).normalized().cast<float>();
  glUniformMatrix4fv(stage.uniform("X_CW"), 1, GL_FALSE, view.data());
  glUniformMatrix4fv(stage.uniform("projection"), 1, GL_FALSE, projection.data());
  glUniform3fv(stage.uniform("eye"), 1, eye.data());
  glUniform3fv(stage.uniform("forward"), 1, forward.data());
  glUniform1i(stage.uniform("perspective"), camera.fov_rad > 0);
  glUniform1i(stage.uniform("headlamp"), scene.light == Light::headlamp);
  glUniform1f(stage.uniform("lamp"), static_cast<float>(scene.lamp_m));
}

// A skin's faces, nearest first as far as a quarter of a metre tells: what they hide is not shaded.
std::vector<std::array<std::uint32_t, 3>> from_near(const Skin& skin, const Camera& camera) {
  constexpr size_t steps = 4096;
  const Eigen::Vector3f forward = (camera.target - camera.eye).normalized().cast<float>(),
                        eye = camera.eye.cast<float>();
  std::vector<std::uint16_t> step(skin.face.size());
  std::vector<std::uint32_t> begin(steps + 1, 0);
  for (size_t f = 0; f < skin.face.size(); ++f) {
    const float depth_m = forward.dot(skin.p[skin.face[f][0]] - eye);
    step[f] = static_cast<std::uint16_t>(std::clamp(4 * depth_m, 0.0f, steps - 1.0f));
    ++begin[step[f] + 1];
  }
  for (size_t s = 1; s < begin.size(); ++s) begin[s] += begin[s - 1];
  std::vector<std::array<std::uint32_t, 3>> sorted(skin.face.size());
  for (size_t f = 0; f < skin.face.size(); ++f) sorted[begin[step[f]]++] = skin.face[f];
  return sorted;
}

void draw(const Stage& stage, const Skin& skin, const Camera& camera) {
  if (skin.face.empty()) return;
  Arrays arrays;
  arrays.vectors(0, skin.p);
  arrays.vectors(1, skin.normal);
  arrays.colours(2, skin.colour);
  arrays.fill(GL_ELEMENT_ARRAY_BUFFER, from_near(skin, camera));
  glUniform1f(stage.uniform("rock"), skin.rock);
  glUniform1f(stage.uniform("gloss"), skin.gloss);
  if (skin.sides == Skin::Sides::inner) {
    glEnable(GL_CULL_FACE);
    glCullFace(GL_FRONT);
  } else {
    glDisable(GL_CULL_FACE);
  }
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * skin.face.size()), GL_UNSIGNED_INT, nullptr);
}

void draw(const Stage& stage, const Dots& dots, const Camera& camera, int height) {
  if (dots.p.empty()) return;
  Arrays arrays;
  arrays.vectors(0, dots.p);
  arrays.colours(2, dots.colour);
  glVertexAttrib3f(1, 0, 0, 1);
  const double half = camera.fov_rad > 0 ? std::tan(camera.fov_rad / 2) : camera.height_m / 2;
  glUniform1f(stage.uniform("dot_px"), static_cast<float>(dots.size_m * height / 2.0 / half));
  glUniform1f(stage.uniform("least_px"), 2 * dots.least_px);
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(dots.p.size()));
}

// Colours and what the depth buffer holds, row 0 at the bottom.
struct Shot {
  std::vector<Colour> pixel;
  std::vector<float> depth;
};

// All that Mesa does: one picture at a time, what follows is done beside the next one.
Shot shoot(const Scene& scene, const Camera& camera, int width, int height) {
  Stage& stage = Stage::the();
  const std::lock_guard lock(stage.mutex);
  stage.open(width, height, scene.background);
  const double aspect = static_cast<double>(width) / height;
  stage.use(false);
  set_look(stage, scene, camera, aspect);
  for (const Skin& skin : scene.skins) draw(stage, skin, camera);
  stage.use(true);
  set_look(stage, scene, camera, aspect);
  for (const Dots& dots : scene.dots) draw(stage, dots, camera, height);
  glFinish();
  Shot shot;
  shot.depth.resize(static_cast<size_t>(width) * height);
  glReadPixels(0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, shot.depth.data());
  shot.pixel = std::move(stage.buffer);
  return shot;
}

// Turns what the depth buffer holds into metres along the view axis; +inf = background.
void to_metres(std::vector<float>& depth, const Camera& camera) {
  const double n = camera.near_m, f = camera.far_m;
  parallel_chunks(depth.size(), 1 << 16, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const double d = depth[k];
      const double m = camera.fov_rad > 0 ? n * f / (f - d * (f - n)) : n + d * (f - n);
      depth[k] = d >= 1 ? INFINITY : static_cast<float>(m);
    }
  });
}

// Darkens what lies deeper than the mean of the pixels on both sides of it: crevices, feet of walls, the ground behind
// an edge. A plane seen at any angle stays as it is: under perspective 1 / depth is linear in the picture. After
// Boucheny, "Interactive scientific visualization of large datasets: towards a perceptive-based approach", 2009.
void darken_crevices(std::vector<Colour>& pixel, const std::vector<float>& depth, const Camera& camera, int width,
                     int height) {
  constexpr std::array<std::array<double, 2>, 4> ways = {{{1, 0}, {0.71, 0.71}, {0, 1}, {-0.71, 0.71}}};
  struct Probe {
    int i, j;
    float radius_px;
  };
  std::vector<Probe> probes;
  for (const double radius_px : {3.0, 8.0, 20.0})
    for (const auto& way : ways)
      probes.push_back({static_cast<int>(std::lround(radius_px * way[0])),
                        static_cast<int>(std::lround(radius_px * way[1])), static_cast<float>(radius_px)});
  const bool perspective = camera.fov_rad > 0;
  const auto px = static_cast<float>((perspective ? 2 * std::tan(camera.fov_rad / 2) : camera.height_m) / height);
  const auto far_m = static_cast<float>(camera.far_m);
  std::vector<float> flat(depth.size());  // linear in the picture over a plane
  parallel_for(
      depth.size(),
      [&](size_t k) {
        const float d = depth[k];
        flat[k] = perspective ? 1 / d : -std::min(d, far_m);
      },
      1 << 16);
  parallel_for(
      static_cast<size_t>(height),
      [&](size_t row) {
        const int y = static_cast<int>(row);
        const float* deep = depth.data() + row * width;
        const float* here = flat.data() + row * width;
        // In float, the sum of twelve probes too: eight bits of colour ask for no more, and four fit into one vector.
        std::vector<float> shade(width, 0.0f), scale(width);  // scale: what a step of `flat` is in pixels' metres
        for (int x = 0; x < width; ++x) scale[x] = perspective ? deep[x] / px : 1 / px;
        for (const Probe& p : probes) {
          const float* one = flat.data() + static_cast<size_t>(std::clamp(y + p.j, 0, height - 1)) * width;
          const float* other = flat.data() + static_cast<size_t>(std::clamp(y - p.j, 0, height - 1)) * width;
          const float per_radius = 1 / p.radius_px;
          const auto probe = [&](int x, int right, int left) {
            const float deeper_px = ((one[right] + other[left]) * 0.5f - here[x]) * scale[x];
            shade[x] += std::min(std::max(deeper_px * per_radius - 0.05f, 0.0f), 1.5f);
          };
          const auto near_edge = [&](int x) {
            probe(x, std::clamp(x + p.i, 0, width - 1), std::clamp(x - p.i, 0, width - 1));
          };
          const int reach = std::abs(p.i), from = std::min(reach, width), to = std::max(from, width - reach);
          for (int x = 0; x < from; ++x) near_edge(x);
          for (int x = from; x < to; ++x) probe(x, x + p.i, x - p.i);  // without a branch: in vectors
          for (int x = to; x < width; ++x) near_edge(x);
        }
        for (int x = 0; x < width; ++x) {
          if (!std::isfinite(deep[x])) continue;
          const float keep = 0.40f + 0.60f * std::exp(-1.6f / 12 * shade[x]);
          Colour& c = pixel[row * width + x];
          const auto dark = [keep](std::uint8_t v) { return static_cast<std::uint8_t>(static_cast<float>(v) * keep); };
          c = {dark(c.r), dark(c.g), dark(c.b), 255};
        }
      },
      16);
}

}  // namespace

Picture take_picture(const Scene& scene, const Camera& camera, int width, int height) {
  const int w = 2 * width, h = 2 * height;
  Shot shot = shoot(scene, camera, w, h);
  to_metres(shot.depth, camera);
  darken_crevices(shot.pixel, shot.depth, camera, w, h);
  Picture large(w, h, {});
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      Colour c = shot.pixel[static_cast<size_t>(h - 1 - y) * w + x];
      c.a = 255;
      large.at(x, y) = c;
    }
  return halve(large);
}

}  // namespace adit
