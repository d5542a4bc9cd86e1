-- SPDX-License-Identifier: MIT
--[[ Sphere-meshes for LuaJIT: build, levels, casts.

  local sphmesh = require "sphmesh"
  local animation = sphmesh.animation(frames, triangles)   -- frames: lists of x, y, z, x, ...; triangles: indices from 0
  local level = animation:build():level(20)
  local hits = level:query(2.5):cast { { 0, 0, 9, 0, 0, -9 } }   -- a ray from (0, 0, 9) to (0, 0, -9)
  if hits[0].hit == 1 then print(hits[0].s, hits[0].contact:place()) end

What fails raises the library's message. Handles go with the garbage collector, which does not know how large they are:
close() those that are. Arrays of C count from 0, and those that a handle lends are there as long as it is open.
]]
local ffi = require "ffi"
local declarations = require "sphmesh.declarations"
local sphmesh = { constants = declarations.constants }
ffi.cdef(declarations.cdef)

local function load(name)
  local file, tried = "lib" .. name .. (ffi.os == "OSX" and ".0.dylib" or ".so.0"), {}
  local places = {}
  for folder in (os.getenv("SPHMESH_LIBRARY_PATH") or ""):gmatch("[^:]+") do
    places[#places + 1] = folder .. "/" .. file
    places[#places + 1] = folder .. "/io/" .. file -- of a build tree
  end
  if #places == 0 then places[1] = file end
  for _, place in ipairs(places) do
    local found, library = pcall(ffi.load, place, name == "sphmesh")
    if found then return library end
    tried[#tried + 1] = library
  end
  error(file .. " was not found; name its folder by SPHMESH_LIBRARY_PATH. Tried: " .. table.concat(tried, "; "))
end

local C = load "sphmesh"
local io = load "sphmesh-io"
sphmesh.C, sphmesh.io = C, io

--- What a word stands for: choice("SPH_RADIUS_", "per_frame").
local function choice(prefix, word)
  local found, value = pcall(function() return C[prefix .. word:upper()] end)
  if not found then error(("%q is no word for %s*"):format(word, prefix), 3) end
  return value
end

--- Options with the library's defaults, and fields of `given` over them.
local function options(struct, given, library)
  local made = ffi.new(struct)
  ;(library or C)[struct .. "_init"](made, ffi.sizeof(struct))
  for name, value in pairs(given or {}) do made[name] = value end
  return made
end

-- Progress. One callback serves all contexts: slots for callbacks are few. It is called on the thread of the call only.
local progress, failure
local function on_progress(_, stage, fraction)
  if progress == nil then return true end
  local fine, answer = pcall(progress, ffi.string(stage), fraction)
  if not fine then failure = { answer } end
  return fine and answer ~= false
end
local progress_callback = ffi.cast("sph_progress_fn *", on_progress)

-- A handle and its context in one value, which the collector knows to destroy.
ffi.cdef [[
typedef struct { sph_context *pointer; } sphmesh_lua_context;
typedef struct { sph_animation *pointer; sph_context *context; } sphmesh_lua_animation;
typedef struct { sph_hierarchy *pointer; sph_context *context; } sphmesh_lua_hierarchy;
typedef struct { sph_level *pointer; sph_context *context; } sphmesh_lua_level;
typedef struct { sph_query *pointer; sph_context *context; } sphmesh_lua_query;
]]

--- A metatype with close() and a collector; `kind` as in sph_<kind>_destroy.
local function define(kind)
  local methods, destroy = {}, C["sph_" .. kind .. "_destroy"]
  function methods.close(self)
    destroy(self.pointer) -- NULL is fine
    self.pointer = nil
  end
  return ffi.metatype("sphmesh_lua_" .. kind, { __index = methods, __gc = methods.close }), methods
end

local new_context, Context = define "context"
local new_animation, Animation = define "animation"
local new_hierarchy, Hierarchy = define "hierarchy"
local new_level, Level = define "level"
local new_query, Query = define "query"

local function check(context, status)
  if status == C.SPH_OK then return end
  local message = ffi.string(C.sph_context_last_message(context))
  error(message ~= "" and message or ffi.string(C.sph_status_text(status)), 3)
end

local function open(self)
  if self.pointer == nil then error("this handle is closed", 3) end
  return self.pointer
end

--- Calls what may take long, or calls back: never from compiled code, which callbacks must not interrupt.
local function call(context, report, f, ...)
  local before = progress
  progress, failure = report, nil
  local status = f(...)
  progress = before
  if failure then
    local told = failure[1]
    failure = nil
    error(told, 0)
  end
  check(context, status)
end
jit.off(call)

--- A new handle of `kind` ("sph_level *"), made by f(..., out).
local function make(new, kind, context, report, f, ...)
  local out = ffi.new(kind .. "[1]")
  local arguments, count = { ... }, select("#", ...)
  arguments[count + 1] = out
  call(context, report, f, unpack(arguments, 1, count + 1))
  return new(out[0], context)
end

--- A context: threads, memory_limit. What is made without one shares one.
function sphmesh.context(given)
  given = given or {}
  local how, out = options "sph_context_options", ffi.new "sph_context *[1]"
  how.thread_count, how.memory_limit = given.threads or 0, given.memory_limit or 0
  how.progress = progress_callback
  local status = C.sph_context_create(how, out)
  if status ~= C.SPH_OK then error(ffi.string(C.sph_status_text(status)), 2) end
  return new_context(out[0])
end

--- Bytes that everything made with the context holds.
function Context:memory_used()
  return tonumber(C.sph_context_memory_used(open(self)))
end

local shared
local function context_of(given)
  if given then return open(given) end
  shared = shared or sphmesh.context()
  return shared.pointer
end

--- A list of numbers, or an array of C with its length in elements, as `kind`, and its length.
local function array(kind, values, count)
  if type(values) == "cdata" then return values, count or ffi.sizeof(values) / ffi.sizeof(kind) end
  return ffi.new(kind .. "[?]", math.max(#values, 1), values), #values
end

--[[ An animation. `frames` is a list with the positions of each frame, x, y, z of one vertex after another: lists, or
arrays of float, which are copied. `triangles` is a list of vertex indices from 0, three for each. ]]
function sphmesh.animation(frames, triangles, context)
  local on = context_of(context)
  local _, numbers = array("float", frames[1])
  local made = make(new_animation, "sph_animation *", on, nil, C.sph_animation_create, on, numbers / 3, #frames)
  for frame, positions in ipairs(frames) do
    local xyz, count = array("float", positions)
    if count ~= numbers then error(("frame %d has %d numbers, not %d"):format(frame - 1, count, numbers), 2) end
    check(on, C.sph_animation_set_frame(made.pointer, frame - 1, xyz, 0))
  end
  local indices, count = array("uint32_t", triangles or {})
  check(on, C.sph_animation_set_triangles(made.pointer, indices, count / 3, 0))
  return made
end

--- Reads an animation from files: see sph_io_open_options, whose fields `given` may have; `cache_path` is a point cache.
function sphmesh.open_animation(path, given, context)
  local on = context_of(context)
  local paths = ffi.new("const char *[1]", { path })
  local how = options("sph_io_open_options", given, io)
  return make(new_animation, "sph_animation *", on, nil, io.sph_io_open_animation, on, paths, 1, how)
end

function Animation:vertex_count() return C.sph_animation_vertex_count(open(self)) end
function Animation:frame_count() return C.sph_animation_frame_count(open(self)) end

--- The hierarchy. `given`: radius = "constant", "per_frame" or "zero"; importance = "curvature" or "none"; progress, told
--- (stage, fraction), which may answer false to cancel; and the numbers of sph_hierarchy_options by their names.
function Animation:build(given)
  local how = options "sph_hierarchy_options"
  local report
  for name, value in pairs(given or {}) do
    if name == "radius" then how.radius_mode = choice("SPH_RADIUS_", value)
    elseif name == "importance" then how.importance = choice("SPH_IMPORTANCE_", value)
    elseif name == "progress" then report = value
    else how[name] = value end
  end
  return make(new_hierarchy, "sph_hierarchy *", self.context, report, C.sph_hierarchy_create, open(self), how)
end

function Hierarchy:vertex_count() return C.sph_hierarchy_vertex_count(open(self)) end
function Hierarchy:collapse_count() return C.sph_hierarchy_collapse_count(open(self)) end

--- The number of spheres of the coarsest level whose error is at most `error`.
function Hierarchy:count_for_error(error)
  local out = ffi.new "uint32_t[1]"
  check(self.context, C.sph_hierarchy_count_for_error(open(self), error, out))
  return out[0]
end

--- The level of so many spheres.
function Hierarchy:level(sphere_count)
  return make(new_level, "sph_level *", self.context, nil, C.sph_level_create, open(self), sphere_count)
end

--- Writes a .sphm file.
function Hierarchy:save(path)
  call(self.context, nil, io.sph_io_save_hierarchy, self.context, open(self), path)
end

function sphmesh.load_hierarchy(path, context)
  local on = context_of(context)
  return make(new_hierarchy, "sph_hierarchy *", on, nil, io.sph_io_load_hierarchy, on, path)
end

function sphmesh.load_level(path, context)
  local on = context_of(context)
  return make(new_level, "sph_level *", on, nil, io.sph_io_load_level, on, path)
end

--- A level of one's own: lists of centres (x, y, z, x, ... of all frames, frame by frame), radii, edges, triangles.
function sphmesh.level(centers, radii, edges, triangles, context)
  local on, arrays = context_of(context), ffi.new "sph_level_arrays"
  local places, numbers = array("float", centers)
  local sizes, spheres = array("float", radii)
  local lines, line_ends = array("uint32_t", edges or {})
  local faces, corners = array("uint32_t", triangles or {})
  arrays.struct_size, arrays.sphere_count, arrays.frame_count = ffi.sizeof(arrays), spheres, numbers / 3 / spheres
  arrays.centers, arrays.radii = places, sizes
  arrays.edges, arrays.edge_count, arrays.triangles, arrays.triangle_count = lines, line_ends / 2, faces, corners / 3
  return make(new_level, "sph_level *", on, nil, C.sph_level_create_from_arrays, on, arrays)
end

function Level:sphere_count() return C.sph_level_sphere_count(open(self)) end
function Level:frame_count() return C.sph_level_frame_count(open(self)) end

--- The parts of the level, as sph_level_arrays; they are the level's, and go with it.
function Level:arrays()
  local out = ffi.new "sph_level_arrays"
  out.struct_size = ffi.sizeof(out)
  check(self.context, C.sph_level_get_arrays(open(self), out))
  return out
end

--- x, y, z and the radius of sphere `index` (from 0) in `frame` (from 0).
function Level:sphere(index, frame)
  local a = self:arrays()
  frame = frame or 0
  if index < 0 or index >= a.sphere_count or frame < 0 or frame >= a.frame_count then
    error(("sphere %d of %d, frame %d of %d"):format(index, a.sphere_count, frame, a.frame_count), 2)
  end
  local place = frame * a.sphere_count + index
  local c = a.centers + 3 * place
  return c[0], c[1], c[2], a.radii[a.radii_per_frame == 1 and place or index]
end

--- Writes .sphm, .json, .obj, .ply or .glb.
function Level:save(path)
  call(self.context, nil, io.sph_io_save_level, self.context, open(self), path)
end

--- The level in one pose, ready for casts; `frame` may lie between two.
function Level:query(frame)
  local made = make(new_query, "sph_query *", self.context, nil, C.sph_query_create, open(self), nil)
  if frame then made:pose(frame) end
  return made
end

--- Poses the level, without making anything anew; gives itself.
function Query:pose(frame)
  check(self.context, C.sph_query_pose_time(open(self), frame))
  return self
end

--- An array of `count` sweeps to fill: from[0..2], to[0..2] and radius of each.
function sphmesh.sweeps(count)
  return ffi.new("sph_sweep[?]", count)
end

--[[ The first contacts of moving spheres, or rays. `sweeps` is a list of { x, y, z, x, y, z, radius }, the radius 0 if it is
left out; or an array of sph_sweep and `count`. Answers an array of sph_hit, `hits` if that is given. ]]
function Query:cast(sweeps, count, hits)
  if type(sweeps) == "table" then
    local given = sweeps
    count = #given
    sweeps = sphmesh.sweeps(count)
    for i, s in ipairs(given) do
      for k = 0, 2 do
        sweeps[i - 1].from[k], sweeps[i - 1].to[k] = s[k + 1], s[k + 4]
      end
      sweeps[i - 1].radius = s[7] or 0
    end
  end
  hits = hits or ffi.new("sph_hit[?]", count)
  check(self.context, C.sph_query_cast(open(self), sweeps, count, hits))
  return hits
end

--- The signed distance of a point, and the nearest place, as sph_contact.
function Query:nearest(x, y, z)
  local point, out = ffi.new("float[3]", x, y, z), ffi.new "sph_nearest"
  check(self.context, C.sph_query_nearest(open(self), point, 0, 1, out))
  return out.distance, out.contact
end

ffi.metatype("sph_contact", {
  __index = {
    --- x, y, z of the point.
    place = function(self) return self.point[0], self.point[1], self.point[2] end,
    --- x, y, z of the normal.
    direction = function(self) return self.normal[0], self.normal[1], self.normal[2] end,
  },
})

--- Version of the library: major * 1000000 + minor * 1000 + patch.
function sphmesh.version() return C.sph_version() end

return sphmesh
