-- How frames of the mesh are read, with what the dissector of all networks has (export/dissector.lua).

-- True if bytes `first` to `last` are exactly a payload with these fields.
local function is_whole(fields, tvb, first, last)
  return first <= last and read(fields, tvb, 8 * first, 8 * last) == 8 * last
end

local function mesh_payload(self, tvb, tree, known, flags, first, last)
  local stop = last
  if bitop.band(flags, SOURCE_ROUTE) ~= 0 and first < last then
    local count = tvb(first, 1):uint()
    if first + 1 + count > last then
      complain(self, tree, MALFORMED, "Malformed: source route")
      return
    end
    list(self.source_route, tvb, first + 1, first + 1 + count, tree)
    first = first + 1 + count
  end
  if bitop.band(flags, DETOURED) ~= 0 and first < last and tvb(last - 1, 1):uint() > 0 then
    local at = last - 1 - tvb(last - 1, 1):uint()
    if is_whole(known.fields, tvb, first, at) then stop = at end
  end
  if not is_whole(known.fields, tvb, first, stop) then
    complain(self, tree, MALFORMED, "Malformed: payload")
  end
  tree:add(self.body, tvb(first, stop - first), known.name):set_hidden()
  local part = tree:add(known.proto, tvb(first, stop - first))
  local _, found = read(known.fields, tvb, 8 * first, 8 * stop, part)
  if stop < last then list(self.failed, tvb, stop, last - 1, tree) end
  return found
end

-- True if the payload of data is a piece of a longer message.
local function is_piece(tvb, kind, found, first, last)
  if kind ~= DATA or found.dest == 255 or bitop.band(found.flags, ORDERED) == 0 then return false end
  return bitop.band(found.flags, SOURCE_ROUTE) == 0 and last - first > PIECE_BYTES
    and tvb(first, 2):uint() == (found.seq + PIECE_AHEAD) % 65536
end

local function mesh_flags(item, flags)
  local set = {}
  for _, flag in ipairs(FLAGS) do
    if bitop.band(flags, flag[1]) ~= 0 then set[#set + 1] = flag[2] end
  end
  if #set > 0 then item:append_text(" (" .. table.concat(set, ", ") .. ")") end
end

local function node(number)
  if number == 255 then return "all" end
  return number == 254 and "monitor" or string.format("%d", number)
end

local function run(self, tvb, tree)
  local size = tvb:len()
  if size < ACK_BYTES then
    complain(self, tree, MALFORMED, "Malformed: too short")
    return "damaged"
  end
  local kind = head(self, tvb, tree, 2, VERSION)
  local last, name, found, info = size - 2, "ack"
  if kind == ACK then
    local behind
    behind, found = read(self.ack, tvb, 8, 8 * last, tree:add(self.hop_ack, tvb()))
    if found then info = string.format("ack of %d's seq %d", found.origin, found.seq) end
    if behind ~= 8 * last then complain(self, tree, MALFORMED, "Malformed: length of an ack") end
  else
    local known, behind = self.kinds[kind]
    name = known and known.name or "unknown type"
    behind, found = read(self.common, tvb, 8, 8 * last, tree)
    if not behind then
      complain(self, tree, MALFORMED, "Malformed: too short")
    else
      mesh_flags(tree, found.flags)
      local path = math.floor(behind / 8)
      local first = path + found.path_len
      if found.path_len > PATH_MAX or first > last then
        complain(self, tree, MALFORMED, "Malformed: path")
      else
        list(self.path, tvb, path, first, tree)
        if known then
          if is_piece(tvb, kind, found, first, last) then
            tree:add(known.proto, tvb(first, last - first)):set_hidden()
            known = self.kinds[PIECE]
          end
          local own = mesh_payload(self, tvb, tree, known, found.flags, first, last)
          info = line(known.name, known.fields, own)
        else
          complain(self, tree, MALFORMED, "Malformed: no packet has this type")
        end
      end
    end
  end
  show_crc(self, tvb, tree)
  if not found then return name end
  if found.dest then
    info = string.format("%s (%d > %s, seq %d)", info or name, found.origin, node(found.dest), found.seq)
  end
  return info, "node " .. node(found.link_src), found.link_dst == 255 and "all" or "node " .. node(found.link_dst)
end
