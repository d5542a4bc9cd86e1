-- SPDX-License-Identifier: MIT
-- Speaks TAP: luajit test.lua, with LUA_PATH and SPHMESH_LIBRARY_PATH set.
local ffi = require "ffi"
local sphmesh = require "sphmesh"
local count, failed = 0, 0

local function test(name, body)
  local fine, message = xpcall(body, debug.traceback)
  count, failed = count + 1, failed + (fine and 0 or 1)
  print((fine and "ok" or "not ok") .. " " .. count .. " - " .. name)
  if not fine then print("# " .. message:gsub("\n", "\n# ")) end
end

local function equal(found, expected, tolerance)
  local same = tolerance and math.abs(found - expected) <= tolerance or found == expected
  if not same then error(("found %s, expected %s"):format(tostring(found), tostring(expected)), 2) end
end

local function refuses(part, f, ...)
  local fine, message = pcall(f, ...)
  if fine then error("no error", 2) end
  if not tostring(message):find(part, 1, true) then error(("message %q lacks %q"):format(message, part), 2) end
end

--- A torus of `rings` times `sides` vertices, drawn out along y from frame to frame.
local function torus(rings, sides, frame_count)
  local frames, triangles = {}, {}
  for f = 1, frame_count do
    local xyz = {}
    for i = 0, rings * sides - 1 do
      local u, v = 2 * math.pi * math.floor(i / sides) / rings, 2 * math.pi * (i % sides) / sides
      local reach = 1 + 0.3 * math.cos(v)
      xyz[#xyz + 1], xyz[#xyz + 2] = reach * math.cos(u), reach * math.sin(u) * (1 + 0.1 * (f - 1))
      xyz[#xyz + 1] = 0.3 * math.sin(v)
    end
    frames[f] = xyz
  end
  for i = 0, rings * sides - 1 do
    local a, b = i - i % sides, (i - i % sides + sides) % (rings * sides)
    local j, k = i % sides, (i + 1) % sides
    for _, corner in ipairs { a + j, b + j, b + k, a + j, b + k, a + k } do triangles[#triangles + 1] = corner end
  end
  return frames, triangles
end

test("the version is that of the headers", function()
  equal(sphmesh.version(), sphmesh.constants.SPH_VERSION)
end)

test("a hierarchy of all vertices gives levels of any number of spheres", function()
  local hierarchy = sphmesh.animation(torus(24, 12, 4)):build()
  equal(hierarchy:vertex_count(), 288)
  equal(hierarchy:collapse_count(), 287)
  equal(hierarchy:count_for_error(math.huge), 1)
  for _, spheres in ipairs { 1, 20, 288 } do
    local level = hierarchy:level(spheres)
    equal(level:sphere_count(), spheres)
    equal(level:frame_count(), 4)
    local labels, seen = level:arrays().labels, {}
    for i = 0, 287 do seen[labels[i]] = true end
    for sphere = 0, spheres - 1 do equal(seen[sphere], true) end
  end
  refuses("289", hierarchy.level, hierarchy, 289)
end)

test("spheres of the finest level are the vertices", function()
  local frames, triangles = torus(24, 12, 4)
  local level = sphmesh.animation(frames, triangles):build():level(288)
  for _, place in ipairs { { 0, 0 }, { 100, 2 }, { 287, 3 } } do
    local x, y, z = level:sphere(unpack(place))
    local xyz = frames[place[2] + 1]
    equal(x, xyz[3 * place[1] + 1], 1e-6)
    equal(y, xyz[3 * place[1] + 2], 1e-6)
    equal(z, xyz[3 * place[1] + 3], 1e-6)
  end
  refuses("sphere 288 of 288", level.sphere, level, 288)
end)

test("positions and triangles may be arrays of C", function()
  local frames, triangles = torus(24, 12, 2)
  local level = sphmesh.animation(frames, triangles):build():level(9)
  for f, xyz in ipairs(frames) do frames[f] = ffi.new("float[?]", #xyz, xyz) end
  local again = sphmesh.animation(frames, ffi.new("uint32_t[?]", #triangles, triangles)):build():level(9)
  equal(ffi.string(level:arrays().centers, 2 * 9 * 12), ffi.string(again:arrays().centers, 2 * 9 * 12))
end)

test("casts hit spheres and capsules where closed forms say", function()
  local level = sphmesh.level({ 0, 0, 0, 4, 0, 0, 0, 5, 0 }, { 1, 1, 2 }, { 0, 1 })
  local hits = level:query():cast { { 2, 0, 9, 2, 0, -9 }, { 2, 0, 9, 2, 0, -9, 0.5 }, { 0, 5, 9, 0, 5, 4 }, { 9, 9, 9, 8, 8, 8 } }
  equal(hits[0].hit, 1)
  equal(hits[0].s, 8 / 18, 1e-6)
  equal(hits[0].contact.kind, sphmesh.C.SPH_SIMPLEX_EDGE)
  local x, y, z = hits[0].contact:place()
  equal(x, 2, 1e-6) equal(y, 0, 1e-6) equal(z, 1, 1e-6)
  equal(select(3, hits[0].contact:direction()), 1, 1e-6)
  equal(hits[1].s, 7.5 / 18, 1e-6)
  equal(hits[2].hit, 0) equal(hits[2].s, 1)
  equal(hits[3].hit, 0)
end)

test("many sweeps in one array answer as one by one", function()
  local query = sphmesh.animation(torus(24, 12, 4)):build():level(20):query(1.5)
  local sweeps, hits = sphmesh.sweeps(500), ffi.new "sph_hit[500]"
  math.randomseed(7)
  for i = 0, 499 do
    for k = 0, 2 do sweeps[i].from[k], sweeps[i].to[k] = 4 * math.random() - 2, 4 * math.random() - 2 end
    sweeps[i].radius = 0.1 * math.random()
  end
  equal(query:cast(sweeps, 500, hits), hits)
  local found = 0
  for i = 0, 499 do
    local alone = query:cast(sweeps + i, 1)
    equal(ffi.string(alone, ffi.sizeof "sph_hit"), ffi.string(hits + i, ffi.sizeof "sph_hit"))
    found = found + alone[0].hit
  end
  equal(found > 50 and found < 450, true)
end)

test("poses between frames are interpolated, and distances are signed", function()
  local query = sphmesh.level({ 0, 0, 0, 4, 0, 0 }, { 1 }):query(0.25)
  equal(query:nearest(10, 0, 0), 8, 1e-6)
  equal(query:pose(1):nearest(4, 0.25, 0), -0.75, 1e-6)
  refuses("frame", query.pose, query, 1.5)
end)

test("files come back as they were", function()
  local name = os.tmpname()
  local hierarchy = sphmesh.animation(torus(24, 12, 2)):build()
  hierarchy:save(name .. ".sphm")
  local mesh = name .. ".obj"
  hierarchy:level(3):save(mesh)
  equal(sphmesh.open_animation(mesh, { scale = 2 }):vertex_count(), 3)
  hierarchy:level(7):save(name .. ".json")
  local again, level = sphmesh.load_hierarchy(name .. ".sphm"), sphmesh.load_level(name .. ".json")
  os.remove(name) os.remove(name .. ".sphm") os.remove(name .. ".json")
  equal(again:vertex_count(), 288)
  local expected = hierarchy:level(7)
  for sphere = 0, 6 do
    local a, b = { expected:sphere(sphere, 1) }, { level:sphere(sphere, 1) }
    for k = 1, 4 do equal(b[k], a[k]) end
  end
  os.remove(mesh)
  refuses("/nowhere", sphmesh.open_animation, "/nowhere.obj")
end)

test("errors have the library's message", function()
  local frames, triangles = torus(24, 12, 2)
  frames[2][31] = 0 / 0
  local animation = sphmesh.animation(frames, triangles)
  refuses("frame 1, vertex 10", animation.build, animation)
  refuses("vertex 288", sphmesh.animation, frames, { 0, 1, 288 })
  refuses("large", animation.build, animation, { radius = "large" })
end)

test("progress is told, cancels, and its errors come out", function()
  local animation, told = sphmesh.animation(torus(24, 12, 4)), {}
  animation:build { progress = function(stage, fraction) told[#told + 1] = { stage, fraction } end }
  equal(told[#told][2], 1)
  refuses("cancelled", animation.build, animation, { progress = function() return false end })
  refuses("torn", animation.build, animation, { progress = function() error("torn") end })
  animation:build()
end)

test("memory comes back by close and by the collector", function()
  local context = sphmesh.context { threads = 1 }
  local empty = context:memory_used()
  local frames, triangles = torus(24, 12, 2)
  do
    local animation = sphmesh.animation(frames, triangles, context)
    local hierarchy = animation:build()
    local level = hierarchy:level(5)
    level:query()
    equal(context:memory_used() > empty, true)
    level:close()
    refuses("closed", level.query, level)
    level:close()
  end
  collectgarbage() collectgarbage()
  equal(context:memory_used(), empty)
  refuses("memory", sphmesh.animation, frames, triangles, sphmesh.context { memory_limit = 5000 })
end)

test("the first lines of the readme work", function()
  local folder = debug.getinfo(1, "S").source:match "^@(.*)tests/test.lua$"
  local file = assert(io.open(folder .. "README.md"))
  local code = file:read("*a"):match "```lua\n(.-)```"
  file:close()
  local told
  local run = assert(loadstring(code))
  setfenv(run, setmetatable({ print = function(...) told = { ... } end }, { __index = _G }))()
  equal(told[1], 1.3, 0.02) equal(told[2], 0, 0.1) equal(told[3], 0, 0.1)
end)

print("1.." .. count)
os.exit(failed == 0 and 0 or 1)
