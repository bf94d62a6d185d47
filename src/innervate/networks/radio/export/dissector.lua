-- How frames of the radio are read, with what the dissector of all networks has (export/dissector.lua).

local function run(self, tvb, tree)
  local size = tvb:len()
  if size == 1 then
    if tvb(0, 1):uint() ~= CARRIER then complain(self, tree, MALFORMED, "Malformed: too short") end
    return "CR-R or pulse", (ends(self)), "all"
  elseif size < 3 then
    complain(self, tree, MALFORMED, "Malformed: too short")
    return "damaged"
  end
  local kind = head(self, tvb, tree, 4, VERSION)
  local name, behind, found = body(self, tvb, tree, kind, 8, 8 * size - 16)
  if behind and behind / 8 < size - 2 then
    local first = math.floor(behind / 8)
    tree:add(self.payload, tvb(first, size - 2 - first))
    if kind == REPORT then complain(self, tree, MALFORMED, "Malformed: too long for its type") end
  end
  show_crc(self, tvb, tree)
  local source = found and found.source and string.format("station %d", found.source)
  return name, source or (ends(self)), "all"
end
