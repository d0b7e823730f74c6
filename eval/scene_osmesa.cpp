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

const char* vertex_shader = R"(#version 330 core
layout(location = 0) in vec3 p;
layout(location = 1) in vec3 n;
layout(location = 2) in vec4 c;
uniform mat4 X_CW;
uniform mat4 projection;
uniform float dot_px, least_px;  // dot size in pixels at depth 1 (perspective) or everywhere; 0 = no dots
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

const char* fragment_shader = R"(#version 330 core
in vec3 p_W, p_C, n_W;
in vec4 tint;
uniform vec3 eye, forward;
uniform bool perspective, dots, headlamp;
uniform float rock, lamp;
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
  if (dots) {
    vec2 d = 2.0 * gl_PointCoord - 1.0;
    if (dot(d, d) > 1.0) discard;
  }
  vec3 to_eye = perspective ? normalize(eye - p_W) : -forward;
  float light = 1.0, gloss = 0.0;
  vec3 base = tint.rgb;
  float distance_m = length(p_C);
  if (!dots) {
    vec3 n = normalize(n_W);
    if (rock > 0.0) {
      vec4 g = grain(p_W);
      float near = 1.0 / (1.0 + 0.02 * distance_m * distance_m);
      n = normalize(n - rock * near * 0.10 * (g.xyz - n * dot(g.xyz, n)));
      base *= mix(1.0, 0.62 + 0.76 * g.w, rock);
    }
    if (dot(n, to_eye) < 0.0) n = -n;
    float head = dot(n, to_eye);
    if (headlamp) {
      light = 0.25 + 0.75 * pow(head, 0.8);
    } else {
      float sky = 0.5 + 0.5 * n.z;
      float key = max(0.0, dot(n, normalize(vec3(-0.5, -0.35, 0.8))));
      light = 0.40 + 0.24 * sky + 0.22 * key + 0.24 * head;
    }
  }
  if (headlamp) light *= (rock > 0.0 ? 1.8 : 1.2) / (1.0 + pow(distance_m / lamp, 1.6));
  colour = vec4(min(base * light + gloss, vec3(1.0)), 1.0);
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
    if (program_ == 0) build_program();
    glViewport(0, 0, width, height);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_PROGRAM_POINT_SIZE);
    glClearColor(background.r / 255.f, background.g / 255.f, background.b / 255.f, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glUseProgram(program_);
  }
  GLint uniform(const char* name) const { return glGetUniformLocation(program_, name); }

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

  static GLuint compile(GLenum kind, const char* source) {
    const GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 1, &source, nullptr);
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
  void build_program() {
    program_ = glCreateProgram();
    glAttachShader(program_, compile(GL_VERTEX_SHADER, vertex_shader));
    glAttachShader(program_, compile(GL_FRAGMENT_SHADER, fragment_shader));
    glLinkProgram(program_);
    GLint good = 0;
    glGetProgramiv(program_, GL_LINK_STATUS, &good);
    ADIT_CHECK(good);
  }

  OSMesaContext context_ = nullptr;
  GLuint program_ = 0;
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

void set_camera(const Stage& stage, const Camera& camera, double aspect) {
  const Eigen::Matrix4f view = view_of(camera), projection = projection_of(camera, aspect);
  const Eigen::Vector3f eye = camera.eye.cast<float>(),
                        forward = (camera.target - camera.eye).normalized().cast<float>();
  glUniformMatrix4fv(stage.uniform("X_CW"), 1, GL_FALSE, view.data());
  glUniformMatrix4fv(stage.uniform("projection"), 1, GL_FALSE, projection.data());
  glUniform3fv(stage.uniform("eye"), 1, eye.data());
  glUniform3fv(stage.uniform("forward"), 1, forward.data());
  glUniform1i(stage.uniform("perspective"), camera.fov_rad > 0);
}

void draw(const Stage& stage, const Skin& skin) {
  if (skin.face.empty()) return;
  Arrays arrays;
  arrays.vectors(0, skin.p);
  arrays.vectors(1, skin.normal);
  arrays.colours(2, skin.colour);
  arrays.fill(GL_ELEMENT_ARRAY_BUFFER, skin.face);
  glUniform1i(stage.uniform("dots"), 0);
  glUniform1f(stage.uniform("rock"), skin.rock);
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
  glUniform1i(stage.uniform("dots"), 1);
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(dots.p.size()));
}

// Distance along the view axis from what the depth buffer holds; +inf = background.
std::vector<float> depths_m(const Camera& camera, int width, int height) {
  std::vector<float> depth(static_cast<size_t>(width) * height);
  glReadPixels(0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, depth.data());
  const double n = camera.near_m, f = camera.far_m;
  parallel_chunks(depth.size(), 1 << 16, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const double d = depth[k];
      const double m = camera.fov_rad > 0 ? n * f / (f - d * (f - n)) : n + d * (f - n);
      depth[k] = d >= 1 ? INFINITY : static_cast<float>(m);
    }
  });
  return depth;
}

// Darkens what lies deeper than the mean of the pixels on both sides of it: crevices, feet of walls, the ground behind
// an edge. A plane seen at any angle stays as it is: under perspective 1 / depth is linear in the picture. After
// Boucheny, "Interactive scientific visualization of large datasets: towards a perceptive-based approach", 2009.
void darken_crevices(std::vector<Colour>& pixel, const std::vector<float>& depth, const Camera& camera, int width,
                     int height) {
  constexpr std::array<std::array<double, 2>, 4> ways = {{{1, 0}, {0.71, 0.71}, {0, 1}, {-0.71, 0.71}}};
  struct Probe {
    int i, j;
    double radius_px;
  };
  std::vector<Probe> probes;
  for (const double radius_px : {3.0, 8.0, 20.0})
    for (const auto& way : ways)
      probes.push_back({static_cast<int>(std::lround(radius_px * way[0])),
                        static_cast<int>(std::lround(radius_px * way[1])), radius_px});
  const bool perspective = camera.fov_rad > 0;
  const double px = (perspective ? 2 * std::tan(camera.fov_rad / 2) : camera.height_m) / height;
  std::vector<double> flat(depth.size());  // linear in the picture over a plane
  parallel_for(
      depth.size(),
      [&](size_t k) {
        const double d = depth[k];
        flat[k] = perspective ? 1 / d : -std::min(d, camera.far_m);
      },
      1 << 16);
  parallel_for(
      static_cast<size_t>(height),
      [&](size_t row) {
        const int y = static_cast<int>(row);
        const float* deep = depth.data() + row * width;
        const double* here = flat.data() + row * width;
        std::vector<double> shade(width, 0.0), per_m(width), scale(width);
        for (int x = 0; x < width; ++x) {
          const double d = deep[x];
          scale[x] = perspective ? d * d : 1;
          per_m[x] = perspective ? d * px : px;
        }
        for (const Probe& p : probes) {
          const double* one = flat.data() + static_cast<size_t>(std::clamp(y + p.j, 0, height - 1)) * width;
          const double* other = flat.data() + static_cast<size_t>(std::clamp(y - p.j, 0, height - 1)) * width;
          const auto probe = [&](int x, int right, int left) {
            const double deeper_m = ((one[right] + other[left]) / 2 - here[x]) * scale[x];
            shade[x] += std::min(std::max(deeper_m / (p.radius_px * per_m[x]) - 0.05, 0.0), 1.5) / 12;
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
          const double keep = 0.40 + 0.60 * std::exp(-1.6 * shade[x]);
          Colour& c = pixel[row * width + x];
          c = {static_cast<std::uint8_t>(c.r * keep), static_cast<std::uint8_t>(c.g * keep),
               static_cast<std::uint8_t>(c.b * keep), 255};
        }
      },
      16);
}

}  // namespace

Picture take_picture(const Scene& scene, const Camera& camera, int width, int height) {
  Stage& stage = Stage::the();
  const std::lock_guard lock(stage.mutex);
  const int w = 2 * width, h = 2 * height;
  stage.open(w, h, scene.background);
  set_camera(stage, camera, static_cast<double>(width) / height);
  glUniform1i(stage.uniform("headlamp"), scene.light == Light::headlamp);
  glUniform1f(stage.uniform("lamp"), static_cast<float>(scene.lamp_m));
  for (const Skin& skin : scene.skins) draw(stage, skin);
  for (const Dots& dots : scene.dots) draw(stage, dots, camera, h);
  glFinish();
  const std::vector<float> depth = depths_m(camera, w, h);
  darken_crevices(stage.buffer, depth, camera, w, h);
  Picture large(w, h, {});
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      Colour c = stage.buffer[static_cast<size_t>(h - 1 - y) * w + x];
      c.a = 255;
      large.at(x, y) = c;
    }
  return halve(large);
}

}  // namespace adit
